// SPDX-License-Identifier: Apache-2.0
// Rollouts with drawn slip noise and a drawn slip disturbance, in lanes (derivations/rollouts.md).
#pragma once

#include "slipwise/rollout/lane_kernel.hpp"
#include "slipwise/rollout/lane_noise.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// Rolls a block with noise in the tangent of every part.
template <class L>
class NoisyRide : public OutputLanes<L> {
 public:
  using Scalar = L::Scalar;
  using Vector = L::Vector;
  using Floats = NormalLanes<L>::Floats;
  using Robot = RobotLanes<L, Actuator::Response, Slip::Any>;

  SLIPWISE_LANES NoisyRide(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block)
      : OutputLanes<L>(job, block), job_(job), plan_(*job.futures), normal_(job.futures->seeds) {}

  SLIPWISE_LANES void start(const Robot& /*robot*/) {
    Vector unused;
    normal_.next_two(constant_[0], constant_[1]);
    normal_.next_two(constant_[2], unused);
    load(plan_.kept, kept_);
    added_ = root_of<Scalar>(Vector{} + 1.0 - kept_ * kept_);
    Vector drawn[kMostDisturbedLanes];
    draw_disturbance(drawn);
    for (std::size_t i = 0; i < kMostDisturbedLanes; ++i) {
      deviation_[i] = drawn[i];
    }
  }

  SLIPWISE_LANES void drive(std::size_t index, Robot& robot) {
    const LanePart<Scalar>& part = job_.parts[index];
    MeanLanes<L> mean;
    move_drive<L, Actuator::Response, Slip::Any>(job_, part, robot, mean);
    TangentLanes<L> tangent;
    slip_part<L, Actuator::Response, Slip::Any>(job_, part, mean, robot, tangent);
    MotionLanes<L> motion;
    find_motion<L>(plan_.noise, mean, job_.vy != nullptr, part.duration, motion);
    Vector noise[3];
    draw_white(part.duration, motion, noise);
    for (std::size_t c = 0; c < 3; ++c) {
      noise[c] = noise[c] + motion.per_channel[c] * constant_[c] * plan_.noise.fraction[c];
    }
    for (std::size_t i = 0; i < plan_.disturbed; ++i) {
      const Vector moved = (plan_.of_turn[i] ? mean.omega : mean.v) * part.duration;
      noise[plan_.channel[i]] = noise[plan_.channel[i]] + deviation_[i] * moved;
    }
    tangent = {tangent.forward + noise[0], tangent.left + noise[1], tangent.turn + noise[2]};
    step<L, true>(tangent, robot.path);
  }

  SLIPWISE_LANES void put_aside() {
    in_tail_ = true;
    tail_time_ = 0;
    for (Vector& white : tail_) {
      white = Vector{};
    }
  }
  /// What follows begins with the time of the tail, whose noise it has.
  SLIPWISE_LANES void take_up() {
    in_tail_ = false;
    drawn_time_ = tail_time_;
    owes_ = true;
  }

  SLIPWISE_LANES void write_piece(const PathLanes<L>& path, std::size_t piece) {
    if (this->wants_piece(piece)) {
      Vector drawn[kMostDisturbedLanes];
      draw_disturbance(drawn);
      for (std::size_t i = 0; i < kMostDisturbedLanes; ++i) {
        deviation_[i] = deviation_[i] * kept_ + drawn[i] * added_;
      }
    }
    OutputLanes<L>::write_piece(path, piece);
  }

 private:
  SLIPWISE_LANES void draw_disturbance(Vector* drawn) {
    for (std::size_t i = 0; i < kMostDisturbedLanes; i += 2) {
      if (i < plan_.disturbed) {
        normal_.next_two(drawn[i], drawn[i + 1]);
      } else {
        drawn[i] = drawn[i + 1] = Vector{};
      }
      for (std::size_t k = i; k < i + 2; ++k) {
        Vector deviation;
        load(plan_.deviation[k], deviation);
        drawn[k] = drawn[k] * deviation;
      }
    }
  }

  /// Numbers come in pairs: of every second time one is left for the next.
  SLIPWISE_LANES void draw_three(Floats* normal) {
    if (spares_) {
      normal[0] = spare_;
      normal_.next_two_floats(normal[1], normal[2]);
    } else {
      normal_.next_two_floats(normal[0], normal[1]);
      normal_.next_two_floats(normal[2], spare_);
    }
    spares_ = !spares_;
  }

  SLIPWISE_LANES void draw_white(Scalar duration, const MotionLanes<L>& motion, Vector* white) {
    const Scalar drawn_time = drawn_time_ < duration ? drawn_time_ : duration;
    const Scalar fresh = (duration - drawn_time) / duration;
    drawn_time_ -= drawn_time;
    Floats normal[3];  // which have the digits of float; so have their deviations
    draw_three(normal);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector variance = white_variance<L>(plan_.noise, motion, c) * fresh;
      const Floats deviation = root_of<float>(__builtin_convertvector(variance, Floats));
      white[c] = __builtin_convertvector(deviation * normal[c], Vector);
      if (in_tail_) {
        tail_[c] = tail_[c] + white[c];
      } else if (owes_) {
        white[c] = white[c] + tail_[c];
      }
    }
    if (in_tail_) {
      tail_time_ += duration;
    }
    owes_ = owes_ && in_tail_;
  }

  const LaneJob<Scalar>& job_;
  const LaneFutures<Scalar>& plan_;
  NormalLanes<L> normal_;
  Vector constant_[3];  ///< normal numbers of the noise that stays
  Vector kept_, added_, deviation_[kMostDisturbedLanes];
  Vector tail_[3];         ///< white noise of the tail
  Scalar tail_time_ = 0;   ///< [s]
  Scalar drawn_time_ = 0;  ///< [s] whose noise is drawn already
  bool in_tail_ = false, owes_ = false;
  Floats spare_;  ///< a normal number, where it `spares_` one
  bool spares_ = false;
};

/// Rolls the block out with noise.
template <class Level, typename Scalar>
unsigned roll_futures(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  using L = Lanes<Unpaired<Level>, Scalar>;
  RobotLanes<L, Actuator::Response, Slip::Any> robot;
  NoisyRide<L> ride(job, block);
  ride_block<L, Actuator::Response, Slip::Any>(job, block, robot, ride);
  return find_faults<L, true>(robot.path, block) | (ride.all_finite(robot.path) ? kNoFault : kNotFinite);
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
