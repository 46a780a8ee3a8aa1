// SPDX-License-Identifier: Apache-2.0
// Drops what is of the sensor; delays to wheel speeds that are stamped late become those to the motion.
#include "slipwise/filter/base_link_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/motion/parameter_block.hpp"

namespace slipwise {
namespace {

constexpr double kShows = 2.0;        // standard deviations
constexpr double kLeastDelay = 2e-3;  // [s] its logarithm is learned

}  // namespace

std::optional<Eigen::Index> place_of_offset(const MotionModel& model) {
  if (!model.learned().clock_offset) {
    return std::nullopt;
  }
  const std::vector<ParameterInfo> names = model.parameters();
  const auto found = std::ranges::find(names, "clock_offset", &ParameterInfo::name);
  return found == names.end() ? std::nullopt : std::optional<Eigen::Index>(found - names.begin());
}

Eigen::Vector2d lateness_of_lags(const MotionModel& model, const Eigen::VectorXd& parameters) {
  return 0.5 * parameters.segment<2>(model.slip_size()).array().exp();
}

KnownModel of_base_link(const MotionModel& model, const Estimate& estimate) {
  ActuatorParameters learned = model.learned();
  learned.sensor_extrinsics = learned.clock_offset = false;
  MotionModel body(model.basis(), learned);
  const Eigen::Index kept = body.size();  // what is of the sensor comes last
  KnownModel found{std::move(body), {estimate.mean.head(kept), estimate.covariance.topLeftCorner(kept, kept)}};
  const std::optional<Eigen::Index> clock = place_of_offset(model);
  const double early = clock ? -estimate.mean[*clock] : 0.0;
  if (!clock || !(early > kShows * std::sqrt(estimate.covariance(*clock, *clock)))) {
    return found;
  }
  Eigen::VectorXd& mean = found.estimate.mean;
  Eigen::MatrixXd by = Eigen::MatrixXd::Identity(kept, model.size());
  const std::vector<ParameterInfo> names = found.model.parameters();
  for (Eigen::Index i = 0; i < kept; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)].name;
    if (name == "log_delay_v" || name == "log_delay_omega") {
      const double to_wheels = std::exp(mean[i]);
      const double to_motion = std::max(to_wheels - early, kLeastDelay);
      mean[i] = std::log(to_motion);
      by(i, i) = to_wheels / to_motion;
      by(i, *clock) = 1.0 / to_motion;
    }
  }
  found.estimate.covariance = by * estimate.covariance * by.transpose();
  return found;
}

}  // namespace slipwise
