// SPDX-License-Identifier: Apache-2.0
// A filter of four states for each source.
#include "slipwise/online/source_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/filter/linear_update.hpp"
#include "slipwise/filter/map_update.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

constexpr double kDifference = 0.01;  // [s, m] of the differences that stand for derivatives
constexpr Eigen::Index kStates = 4;
SLIPWISE_TUNING(kClockDrift, 2e-3);  // [s] per segment: what was learned while the model knew little is forgotten
SLIPWISE_TUNING(kPlaceDrift, 4e-3);  // [m, rad] the same

}  // namespace

/// A segment of a source as a measurement of how late it is and where it sits.
struct SourceCalibration::Seen {
  using ByState = Eigen::Matrix<double, Eigen::Dynamic, kStates, Eigen::ColMajor, kMostRows, kStates>;
  struct At {
    Rows predicted;
    ByState jacobian;
  };
  using Innovation = Rows;

  const MotionPosterior& posterior;
  const DrivenSegment& driven;
  RowsCovariance covariance = {};

  SegmentPath path(const Eigen::VectorXd& state) const {
    return integrate_segment(posterior.model, posterior.estimate.mean, driven.inputs, placed(driven.segment, state));
  }
  At at(const Eigen::VectorXd& state) const {
    const SegmentPath here = path(state);
    const std::vector<slipwise::Seen> seen = here.seen();
    At found{.predicted = stacked(seen), .jacobian = {}};
    const Eigen::VectorXd later = kDifference * Eigen::VectorXd::Unit(kStates, 0);
    found.jacobian.resize(found.predicted.size(), kStates);
    found.jacobian.col(0) = (path(state + later).rows() - path(state - later).rows()) / (2.0 * kDifference);
    Eigen::Index row = 0;
    for (const slipwise::Seen& each : seen) {
      found.jacobian.middleRows(row, each.z.size()).rightCols<3>() = each.by_place;
      row += each.z.size();
    }
    return found;
  }
  Innovation innovation(const At& at) const { return rows_of(driven.segment.measured) - at.predicted; }
  static const ByState& jacobian(const At& at) { return at.jacobian; }
  const RowsCovariance& noise(const At& /*at*/) const { return covariance; }
};

SourceCalibration::SourceCalibration(const SourceSettings& settings)
    : estimate_{Eigen::VectorXd::Zero(kStates), Eigen::MatrixXd::Zero(kStates, kStates)} {
  estimate_.mean.tail<3>() = settings.sensor.vector();
  estimate_.covariance.diagonal() << std::pow(settings.clock_std, 2), std::pow(settings.sensor_std_xy, 2),
      std::pow(settings.sensor_std_xy, 2), std::pow(settings.sensor_std_yaw, 2);
}

Segment SourceCalibration::placed(const Segment& segment, const Eigen::VectorXd& at) {
  Segment moved = segment;
  const double late = std::clamp(at[0], -kClocksApart, kClocksApart);
  moved.start -= late;
  moved.end -= late;
  for (auto& [sensor, z] : moved.measured) {
    come_earlier(sensor, late);
    sensor.place = Pose2::from_vector(at.tail<3>());
  }
  return moved;
}

void SourceCalibration::learn(const MotionPosterior& posterior, const DrivenSegment& driven,
                              const IekfSettings& settings) {
  for (Eigen::Index i = 0; i < kStates; ++i) {
    const double drift = i == 0 ? kClockDrift : kPlaceDrift;
    estimate_.covariance(i, i) += estimate_.covariance(i, i) > 0.0 ? drift * drift : 0.0;
  }
  const auto at = linearize_segment(posterior.model, posterior.estimate.mean, driven.inputs, corrected(driven.segment));
  Seen seen{posterior, driven};
  seen.covariance = prediction_covariance(at, posterior.estimate.covariance, posterior.noise, posterior.noise_scale);
  const MapUpdate problem(estimate_, seen);
  auto now = problem.begin(seen.at(estimate_.mean));
  const double nis =
      normalised_square(now.innovation, innovation_covariance(estimate_.covariance, now.at.jacobian, seen.covariance));
  if (!(nis <= settings.gate)) {
    return;
  }
  seen.covariance *= std::max(std::sqrt(nis) / settings.huber, 1.0);
  now = problem.begin(std::move(now.at));
  if (!problem.minimize(now, settings.map())) {
    return;
  }
  estimate_.mean = now.state;
  linear_update(estimate_.covariance, now.at.jacobian, seen.covariance);
}

Rows SourceCalibration::open(const MotionPosterior& posterior, const DrivenSegment& driven) const {
  const Seen seen{posterior, driven};
  const auto at = seen.at(estimate_.mean);
  const RowsCovariance noise = segment_noise(seen.path(estimate_.mean), rows_of(driven.segment.measured),
                                             posterior.noise, posterior.noise_scale);
  const RowsCovariance unknown = at.jacobian * estimate_.covariance * at.jacobian.transpose();
  return unknown.diagonal().cwiseQuotient(noise.diagonal());
}

}  // namespace slipwise
