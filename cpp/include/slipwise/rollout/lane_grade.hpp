// SPDX-License-Identifier: Apache-2.0
// A plane that is not level, in lanes: gravity along the robot's axes, and a step as it is seen from above
// (derivations/slopes-and-forces.md).
#pragma once

#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lane_slip.hpp"
#include "slipwise/rollout/lanes.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

template <class L>
struct HeadingLanes {
  L::Vector cosine, sine;
};

/// One over the root of 1 + u, u from 0 to 3, by Newton's method.
template <class Vector, typename Scalar>
SLIPWISE_LANES void inverse_root(const Vector& u, const Scalar* numbers, Vector& root) {
  // numbers: 1, 3/2, 1/2, 1/4, 3/4
  Vector one;
  fill(numbers[0], one);
  const Vector x = u + numbers[0];
  root = (u * numbers[3] + one) / (u * numbers[4] + one);
  for (int i = 0; i < 4; ++i) {
    Vector most;
    fill(numbers[1], most);
    root = root * (most - x * (root * root) * numbers[2]);
  }
}

/// The tilt at the heading that the drive has amid the step, before which it is `heading`; `half` is half of its turn.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void find_grade(const LaneJob<Scalar>& job, const HeadingLanes<L>& heading,
                               const typename L::Vector& half, GradeLanes<L>& grade) {
  using Vector = L::Vector;
  const Scalar numbers[] = {static_cast<Scalar>(1), static_cast<Scalar>(1.5), static_cast<Scalar>(0.5),
                            static_cast<Scalar>(0.25), static_cast<Scalar>(0.75)};
  const auto minus_third = static_cast<Scalar>(-1.0 / 6.0);
  const auto minus_half = static_cast<Scalar>(-0.5);
  const Vector squared = half * half;
  const Vector sine_half = half * (squared * minus_third + numbers[0]);
  const Vector cosine_half = squared * (squared * static_cast<Scalar>(1.0 / 24.0) + minus_half) + numbers[0];
  const Vector c = heading.cosine * cosine_half - heading.sine * sine_half;
  const Vector s = heading.sine * cosine_half + heading.cosine * sine_half;
  const Vector ahead = c * job.rise_x + s * job.rise_y;
  const Vector left = c * job.rise_y - s * job.rise_x;
  inverse_root(ahead * ahead, numbers, grade.cos_pitch);
  const Vector tan_roll = left * grade.cos_pitch;
  inverse_root(tan_roll * tan_roll, numbers, grade.cos_roll);
  const Vector sin_roll = tan_roll * grade.cos_roll;
  const Vector minus_sin_pitch = ahead * grade.cos_pitch;
  grade.gx = minus_sin_pitch * job.minus_gravity;
  grade.gy = (grade.cos_pitch * sin_roll) * job.minus_gravity;
  grade.across = (minus_sin_pitch * sin_roll) * static_cast<Scalar>(-1);
  grade.upward = grade.cos_roll / grade.cos_pitch;
}

/// A tangent in the robot's axes becomes what is seen of it from above.
template <class L>
SLIPWISE_LANES void see_from_above(const GradeLanes<L>& grade, TangentLanes<L>& tangent) {
  tangent.forward = tangent.forward * grade.cos_pitch + tangent.left * grade.across;
  tangent.left = tangent.left * grade.cos_roll;
  tangent.turn = tangent.turn * grade.upward;
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
