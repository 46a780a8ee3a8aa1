// SPDX-License-Identifier: Apache-2.0
// Slip noise of a part of a rollout, in lanes, and normal numbers to draw it from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

#include "slipwise/lie/lane_arc.hpp"
#include "slipwise/rollout/lane_noise_job.hpp"
#include "slipwise/rollout/lane_slip.hpp"
#include "slipwise/rollout/lanes.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// How far a part moves a robot, as noise grows with it (motion_noise.hpp).
template <class L>
struct MotionLanes {
  L::Vector per_channel[3];
  L::Vector moving;  ///< the part's duration, or nothing of it where the robot stands
};

template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void find_motion(const LaneNoise<Scalar>& noise, const MeanLanes<L>& mean, bool sideways,
                                Scalar duration, MotionLanes<L>& motion) {
  using Vector = L::Vector;
  Vector distance = magnitude(mean.v) * duration;
  if (sideways) {
    distance = root_of<Scalar>(mean.v * mean.v + mean.vy * mean.vy) * duration;
  }
  const Vector turn = magnitude(mean.omega) * duration;
  const Vector wheels = distance + turn * noise.turn_radius;
  motion.per_channel[0] = wheels;
  motion.per_channel[1] = wheels;
  motion.per_channel[2] = turn + distance * noise.per_straight_radius;
  motion.moving = wheels > Vector{} ? Vector{} + duration : Vector{};
}

/// Variance of a part's white noise in a channel.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES L::Vector white_variance(const LaneNoise<Scalar>& noise, const MotionLanes<L>& motion,
                                        std::size_t channel) {
  return motion.moving * noise.psd_time[channel] + motion.per_channel[channel] * noise.psd_motion[channel];
}

/// The natural logarithm of numbers above zero, to the digits of float.
template <class Vector, class Integers>
SLIPWISE_LANES void logarithm(const Vector& x, Vector& result) {
  Integers bits;
  __builtin_memcpy(&bits, &x, sizeof(bits));
  const Integers exponent = (bits - 0x3F3504F3) >> 23;  // of a number from the root of a half on
  bits = bits - (exponent << 23);
  Vector fraction;
  __builtin_memcpy(&fraction, &bits, sizeof(bits));
  const Vector t = (fraction - 1.0F) / (fraction + 1.0F);
  const Vector q = t * t;
  const Vector series = ((q * (1.0F / 9) + 1.0F / 7) * q + 1.0F / 5) * q + 1.0F / 3;
  result = __builtin_convertvector(exponent, Vector) * std::numbers::ln2_v<float> + (t + t) * (q * series + 1.0F);
}

/// Normal numbers, independent in every lane: xoshiro128++ (Blackman and Vigna 2021), and two of them into two normal
/// numbers (Box and Muller 1958). They reach 5.8 standard deviations.
template <class L>
class NormalLanes {
 public:
  static constexpr std::size_t kBytes = 4 * L::kLanes;
  using Vector = L::Vector;
  using Floats = NativeVector<float, kBytes>::Type;
  using Integers = NativeVector<std::int32_t, kBytes>::Type;
  using Bits = NativeVector<std::uint32_t, kBytes>::Type;

  SLIPWISE_LANES explicit NormalLanes(const std::uint32_t (*seeds)[kMostLanes]) {
    for (std::size_t i = 0; i < 4; ++i) {
      load(seeds[i], state_[i]);
    }
  }

  SLIPWISE_LANES void next_two(Vector& one, Vector& other) {
    Floats first, second;
    next_two_floats(first, second);
    one = __builtin_convertvector(first, Vector);
    other = __builtin_convertvector(second, Vector);
  }

  SLIPWISE_LANES void next_two_floats(Floats& one, Floats& other) {
    const Integers first = bits(), second = bits();
    // from 2^-24 to 1, and half a turn to each side
    const Floats uniform = __builtin_convertvector((first >> 8) & 0xFFFFFF, Floats) * 0x1p-24F + 0x1p-24F;
    const Floats angle = __builtin_convertvector(second, Floats) * (std::numbers::pi_v<float> * 0x1p-31F);
    Floats log;
    logarithm<Floats, Integers>(uniform, log);
    const Floats radius = root_of<float>(log * -2.0F);
    LaneArc<Floats> arc;
    wide_lane_arc<float>(angle, arc);
    one = radius - radius * (angle * arc.b);
    other = radius * (angle * arc.a);
  }

 private:
  SLIPWISE_LANES static Bits rotated(const Bits& bits, int by) { return (bits << by) | (bits >> (32 - by)); }
  SLIPWISE_LANES Integers bits() {
    const Bits result = rotated(state_[0] + state_[3], 7) + state_[0];
    const Bits shifted = state_[1] << 9;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotated(state_[3], 11);
    Integers drawn;
    __builtin_memcpy(&drawn, &result, sizeof(drawn));
    return drawn;
  }

  Bits state_[4];
};

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
