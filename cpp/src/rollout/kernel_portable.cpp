// SPDX-License-Identifier: Apache-2.0
// The rollout kernels for any processor that runs the rest of the library.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "slipwise/rollout/lane_car.hpp"
#include "slipwise/rollout/lane_kernel.hpp"
#include "slipwise/rollout/lane_limiter.hpp"
#include "slipwise/rollout/uncertain_kernels.hpp"

namespace slipwise {
namespace {

struct Level {
  static constexpr std::size_t kBytes = 16;
  static constexpr std::size_t kPairs = 1;
  static constexpr bool kSingleLoop = true;  ///< a loop of its own without an actuator: measured, here it is faster
};

}  // namespace

LaneKernelOfLevel<float> portable_kernel(float /*scalar*/) {
  return {roll_block<Level, float>, limit_block<Level, float>, drive_cars<Level, float>, Lanes<Level, float>::kLanes};
}
LaneKernelOfLevel<double> portable_kernel(double /*scalar*/) {
  return {roll_block<Level, double>, limit_block<Level, double>, drive_cars<Level, double>,
          Lanes<Level, double>::kLanes};
}

UncertainKernels<float> portable_uncertain(float /*scalar*/) { return uncertain_kernels<Level, float>(); }
UncertainKernels<double> portable_uncertain(double /*scalar*/) { return uncertain_kernels<Level, double>(); }

}  // namespace slipwise
