// SPDX-License-Identifier: Apache-2.0
// Drops what is of the sensor; delays to wheel speeds that are stamped late become those to the motion.
#include "slipwise/filter/base_link_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "slipwise/motion/parameter_block.hpp"

namespace slipwise {
namespace {

constexpr double kSure = 2.0;         // standard deviations
constexpr double kLeastDelay = 2e-3;  // [s] its logarithm is learned

}  // namespace

KnownModel of_base_link(const MotionModel& model, const Estimate& estimate) {
  const std::vector<ParameterInfo> all = model.parameters();
  ActuatorParameters learned = model.learned();
  learned.sensor_extrinsics = learned.clock_offset = false;
  MotionModel body(model.basis(), learned);
  const Eigen::Index kept = body.size();  // what is of the sensor comes last
  Eigen::VectorXd mean = estimate.mean.head(kept);
  Eigen::MatrixXd by = Eigen::MatrixXd::Identity(kept, model.size());
  const auto found = std::ranges::find(all, "clock_offset", &ParameterInfo::name);
  if (found != all.end()) {
    const Eigen::Index clock = found - all.begin();
    const double early = -estimate.mean[clock];
    const bool sure = early > kSure * std::sqrt(estimate.covariance(clock, clock));
    for (Eigen::Index i = 0; sure && i < kept; ++i) {
      const std::string& name = all[static_cast<std::size_t>(i)].name;
      if (name == "log_delay_v" || name == "log_delay_omega") {
        const double to_wheels = std::exp(mean[i]);
        const double to_motion = std::max(to_wheels - early, kLeastDelay);
        mean[i] = std::log(to_motion);
        by(i, i) = to_wheels / to_motion;
        by(i, clock) = 1.0 / to_motion;
      }
    }
  }
  Eigen::MatrixXd covariance = by * estimate.covariance * by.transpose();
  return {std::move(body), {std::move(mean), std::move(covariance)}};
}

}  // namespace slipwise
