// SPDX-License-Identifier: Apache-2.0
// Histories as the channels of a drive that steers see them.
#include "slipwise/actuator/kinematics.hpp"

#include <cstddef>
#include <utility>
#include <vector>

namespace slipwise {

InputHistory channel_inputs(const InputHistory& commands, double wheelbase) {
  std::vector<double> t;
  std::vector<BodyTwist> twist;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    t.push_back(commands.time(i));
    twist.push_back(channel_input(commands.sample(i), wheelbase));
  }
  return {std::move(t), std::move(twist)};
}

InputHistory measured_channels(const InputHistory& measured, double wheelbase) {
  std::vector<double> t;
  std::vector<BodyTwist> twist;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    BodyTwist now = channel_input(measured.sample(i), wheelbase);
    if (!shows_curvature(measured.sample(i))) {
      now.omega = i > 0 ? twist.back().omega : 0.0;
    }
    t.push_back(measured.time(i));
    twist.push_back(now);
  }
  return {std::move(t), std::move(twist)};
}

}  // namespace slipwise
