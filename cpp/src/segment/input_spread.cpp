// SPDX-License-Identifier: Apache-2.0
// One integration for each direction in which the inputs may differ.
#include "slipwise/segment/input_spread.hpp"

#include <algorithm>
#include <cstddef>

#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

/// Charts of the sensor's motion at times, on straight lines between steps.
std::vector<Eigen::Vector3d> charts_at(const SegmentPath& path, const std::vector<double>& times) {
  const auto chart = [&path](std::size_t k) { return sensor_motion(path.poses[k], path.sensor()).vector(); };
  std::vector<Eigen::Vector3d> charts;
  for (const double t : times) {
    const auto above = static_cast<std::size_t>(std::ranges::upper_bound(path.times, t) - path.times.begin());
    if (above == 0 || above == path.times.size()) {
      charts.push_back(chart(above == 0 ? 0 : above - 1));
    } else {
      const double part = (t - path.times[above - 1]) / (path.times[above] - path.times[above - 1]);
      const Eigen::Vector3d before = chart(above - 1);
      charts.emplace_back(before + part * chart_error(chart(above), before));
    }
  }
  return charts;
}

}  // namespace

RowsCovariance input_covariance(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                const DrivenSegment& driven, const InputSpread& spread) {
  const Directions directions = directions_of(driven.segment.measured);
  RowsCovariance sum = RowsCovariance::Zero(directions.size(), directions.size());
  if (spread.deviated.empty()) {
    return sum;
  }
  const auto end = [&](const InputHistory& inputs) {
    return integrate_segment(model, parameters, inputs, driven.segment).rows();
  };
  const Rows expected = end(driven.inputs);
  for (const InputHistory& inputs : spread.deviated) {
    const Rows off = shorter_error(directions, end(inputs), expected) / spread.step;
    sum += off * off.transpose();
  }
  return sum;
}

std::vector<Eigen::Matrix3d> input_covariances(const MotionModel& model,
                                               const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                               const DrivenSegment& driven, const InputSpread& spread,
                                               const std::vector<double>& times) {
  std::vector<Eigen::Matrix3d> sums(times.size(), Eigen::Matrix3d::Zero());
  if (spread.deviated.empty()) {
    return sums;
  }
  const auto along = [&](const InputHistory& inputs) {
    return charts_at(integrate_segment(model, parameters, inputs, driven.segment), times);
  };
  const std::vector<Eigen::Vector3d> expected = along(driven.inputs);
  for (const InputHistory& inputs : spread.deviated) {
    const std::vector<Eigen::Vector3d> deviated = along(inputs);
    for (std::size_t i = 0; i < times.size(); ++i) {
      const Eigen::Vector3d off = chart_error(deviated[i], expected[i]) / spread.step;
      sums[i] += off * off.transpose();
    }
  }
  return sums;
}

}  // namespace slipwise
