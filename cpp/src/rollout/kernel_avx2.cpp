// SPDX-License-Identifier: Apache-2.0
// The rollout kernels for processors with AVX2 and fused multiply-add (x86-64-v3).
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

// All that holds more than templates comes before the processor is named.
#include <cmath>

#include "slipwise/linear/plain_value.hpp"
#include "slipwise/rollout/drive_command.hpp"
#include "slipwise/rollout/lane_tangent_job.hpp"
#include "slipwise/rollout/slip_factor.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("arch=x86-64-v3"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v3")
#endif
#define SLIPWISE_HAS_LEVEL
#include "slipwise/rollout/lane_car.hpp"
#include "slipwise/rollout/lane_kernel.hpp"
#include "slipwise/rollout/lane_limiter.hpp"
#include "slipwise/rollout/uncertain_kernels.hpp"
#endif

namespace slipwise {
#ifdef SLIPWISE_HAS_LEVEL
namespace {

/// Its name is known in this file alone: what is compiled for it is used by it alone.
struct Level {
  static constexpr std::size_t kBytes = 32;
  static constexpr std::size_t kPairs = 1;
  static constexpr bool kSingleLoop = true;  ///< a loop of its own without an actuator: measured, here it is faster
};

template <typename Scalar>
LaneKernelOfLevel<Scalar> kernel() {
  return {roll_block<Level, Scalar>, limit_block<Level, Scalar>, drive_cars<Level, Scalar>,
          Lanes<Level, Scalar>::kLanes};
}

}  // namespace
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

LaneKernelOfLevel<float> avx2_kernel(float /*scalar*/) { return kernel<float>(); }
LaneKernelOfLevel<double> avx2_kernel(double /*scalar*/) { return kernel<double>(); }
UncertainKernels<float> avx2_uncertain(float /*scalar*/) { return uncertain_kernels<Level, float>(); }
UncertainKernels<double> avx2_uncertain(double /*scalar*/) { return uncertain_kernels<Level, double>(); }
#else
LaneKernelOfLevel<float> avx2_kernel(float /*scalar*/) { return {nullptr, nullptr, nullptr, 0}; }
LaneKernelOfLevel<double> avx2_kernel(double /*scalar*/) { return {nullptr, nullptr, nullptr, 0}; }
UncertainKernels<float> avx2_uncertain(float /*scalar*/) { return {}; }
UncertainKernels<double> avx2_uncertain(double /*scalar*/) { return {}; }
#endif

}  // namespace slipwise
