// SPDX-License-Identifier: Apache-2.0
// A rollout with its tangents, in lanes: what every pose changes by with each column of lane_tangent_job.hpp, the sums
// of slip noise along the way, and the covariance of every pose from both (derivations/rollouts.md).
#pragma once

#include "slipwise/rollout/lane_covariance.hpp"
#include "slipwise/rollout/lane_dual.hpp"
#include "slipwise/rollout/lane_kernel.hpp"
#include "slipwise/rollout/lane_noise.hpp"
#include "slipwise/rollout/lane_step.hpp"
#include "slipwise/rollout/lane_tangent_rows.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// What the tangent of a part changes by with what was before it; with the first two alone on level ground without
/// edges, where the robot does not drive sideways.
enum Seed : std::uint8_t { kMeanV, kMeanOmega, kMeanVy, kHeading, kTravelled, kDuration, kSeeds };
inline constexpr int kPlainSeeds = 2;

/// Rolls a block with its tangents, of which each part has those by the first kBy seeds.
template <class L, int kBy>
class TangentRide {
 public:
  using Scalar = L::Scalar;
  using Vector = L::Vector;
  using Robot = RobotLanes<L, Actuator::Response, Slip::Any>;
  using Differentiable = DualLanes<L, kBy>;
  static constexpr auto kOne = static_cast<Scalar>(1);
  static constexpr bool kPlain = kBy == kPlainSeeds;
  static constexpr std::size_t kChannels = kPlain ? 2 : 3;  ///< of the drive

  SLIPWISE_LANES TangentRide(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block)
      : job_(job),
        block_(block),
        plan_(*job.tangents),
        last_piece_(job.pieces - 1),
        along_ground_(!kPlain && (job.on_grade || job.edge_count > 0)),
        rows_(plan_, kChannels, along_ground_) {}

  SLIPWISE_LANES void start(const Robot& robot) {
    rows_.clear();
    for (std::size_t i = 0; i < plan_.actuator; ++i) {
      for (std::size_t channel = 0; channel < kChannels; ++channel) {
        for (std::size_t held = 1; held < 3; ++held) {
          Vector by;
          load(plan_.start[i].by[channel][held], by);
          rows_.put(rows_.drive_row(i, channel) + held, by);
        }
      }
    }
    take_speed(robot.v.next);
    take_command(robot.omega.next, 1);
    start_cosine_ = robot.path.cosine;
    start_sine_ = robot.path.sine;
  }

  SLIPWISE_LANES void drive(std::size_t index, Robot& robot) {
    const LanePart<Scalar>& part = job_.parts[index];
    if (part.next_v) {
      take_speed(robot.v.next);
    }
    if (part.next_omega) {
      take_command(robot.omega.next, 1);
    }
    if (along_ground_ || plan_.actuator > 0) {
      drive_with_seeds(index, robot);
      return;
    }
    MeanLanes<L> mean;
    move_drive<L, Actuator::Response, Slip::Any>(job_, part, robot, mean);
    ProductLanes<L> products;
    TangentLanes<L> tangent;
    slip_tangent<L>(job_, {job_.coefficients + part.first_coefficient, nullptr, job_.vy != nullptr}, mean, products,
                    tangent);
    StepLanes<Vector> by;
    step_with_tangents<L>(tangent, robot.path, by);
    add_noise(part, mean, by);
    add_columns(part, [&](std::size_t product) -> const Vector& { return products.value[product]; }, by);
  }

  SLIPWISE_LANES void put_aside() { rows_.put_aside(); }
  SLIPWISE_LANES void take_up() { rows_.take_up(); }
  SLIPWISE_LANES bool wants_piece(std::size_t piece) const { return piece == last_piece_; }
  SLIPWISE_LANES void write_piece(const PathLanes<L>& path, std::size_t piece) {
    if (piece == last_piece_) {
      write(path);
      ++period_;
      last_piece_ += job_.pieces;
    }
  }

 private:
  using Wide = Differentiable::Vector;

  /// A command began to act. What was before all commands keeps the drive as it is, and hangs on its parameters.
  SLIPWISE_LANES void take_command(std::ptrdiff_t next, std::size_t channel) {
    const bool keeps = next - 1 < job_.start_row && block_.past_count == 0;
    for (std::size_t i = 0; i < plan_.actuator; ++i) {
      Vector by{};
      if (keeps) {
        load(plan_.start[i].by[channel][0], by);
      }
      rows_.put(rows_.drive_row(i, channel), by);
    }
  }
  SLIPWISE_LANES void take_speed(std::ptrdiff_t next) {
    take_command(next, 0);
    if constexpr (!kPlain) {
      take_command(next, 2);
    }
  }

  /// A part, and how it hangs on what was before it.
  struct Part {
    const LanePart<Scalar>* numbers;
    AnyPart<Differentiable> any;
    TangentLanes<Differentiable> tangent;
    Wide travelled;
    StepLanes<Vector> by;
    Vector speed, curvature;  ///< means of a drive that steers
  };

  SLIPWISE_LANES void drive_with_seeds(std::size_t index, Robot& robot) {
    const LanePart<Scalar>& numbers = job_.parts[index];
    Part part;
    part.numbers = &numbers;
    const Robot before = robot;
    MeanLanes<L> mean;
    move_drive<L, Actuator::Response, Slip::Any>(job_, numbers, robot, mean);
    if (job_.sharpest > 0) {
      ChannelLanes<L, Actuator::Response> steering = before.omega;
      advance<L, Actuator::Response, false>(numbers.omega, steering, part.curvature);
      part.speed = mean.v;
    }
    slip_with_seeds(mean, robot, part);
    const TangentLanes<L> tangent{part.tangent.forward.value, part.tangent.left.value, part.tangent.turn.value};
    step_with_tangents<L>(tangent, robot.path, part.by);
    if constexpr (!kPlain) {
      robot.travelled = part.travelled.value;
    }
    add_noise(numbers, mean, part.by);
    for (std::size_t i = 0; i < plan_.actuator; ++i) {
      add_actuator(i, plan_.parts[index * plan_.actuator + i], before, part);
    }
    if (along_ground_) {
      if constexpr (!kPlain) {
        add_columns_on_ground(part);
      }
    } else {
      add_columns(
          numbers, [&](std::size_t product) -> const Vector& { return part.any.products.value[product].value; },
          part.by);
    }
  }

  SLIPWISE_LANES void slip_with_seeds(const MeanLanes<L>& mean, const Robot& robot, Part& part) const {
    PartStart<Differentiable, Wide> from;
    from.coefficients = job_.coefficients + part.numbers->first_coefficient;
    from.mean.v = Wide::variable(mean.v, kMeanV);
    from.mean.omega = Wide::variable(mean.omega, kMeanOmega);
    if constexpr (kPlain) {
      slip_tangent<Differentiable>(job_, {from.coefficients, nullptr, false}, from.mean, part.any.products,
                                   part.any.driven);
      part.tangent = part.any.driven;
    } else {
      if (job_.vy != nullptr) {
        from.mean.vy = Wide::variable(mean.vy, kMeanVy);
      }
      from.duration = Wide::variable(Vector{} + part.numbers->duration, kDuration);
      from.heading = {robot.path.cosine, robot.path.sine};
      from.heading.cosine.by[kHeading] = -robot.path.sine;
      from.heading.sine.by[kHeading] = robot.path.cosine;
      part.travelled = Wide::variable(robot.travelled, kTravelled);
      any_tangent<Differentiable>(job_, from, part.travelled, part.any, part.tangent);
    }
  }

  /// Moves the drive's derivatives on over a part; returns the one of its mean.
  SLIPWISE_LANES Vector move_channel(std::size_t row, const ChannelLanes<L, Actuator::Response>& before,
                                     const LaneLag<Scalar>& lag, const LaneLag<Scalar>& by) {
    const Vector input = rows_.get(row), fast = rows_.get(row + 1), slow = rows_.get(row + 2);
    rows_.put(row + 1, input * lag.fast_by_input + fast * lag.fast_by_fast + before.input * by.fast_by_input +
                           before.fast * by.fast_by_fast);
    rows_.put(row + 2, input * lag.slow_by_input + slow * lag.slow_by_slow + before.input * by.slow_by_input +
                           before.slow * by.slow_by_slow);
    return input * lag.mean_by_input + fast * lag.mean_by_fast + slow * lag.mean_by_slow +
           before.input * by.mean_by_input + before.fast * by.mean_by_fast + before.slow * by.mean_by_slow;
  }

  /// What a column changes of a part, carried back to the start.
  SLIPWISE_LANES void add_step(std::size_t column, const TangentLanes<L>& change, const StepLanes<Vector>& by) {
    rows_.add(rows_.x_row(column), by.x[0] * change.forward + by.x[1] * change.left + by.x[2] * change.turn);
    rows_.add(rows_.y_row(column), by.y[0] * change.forward + by.y[1] * change.left + by.y[2] * change.turn);
    rows_.add(rows_.turn_row(column), change.turn);
  }

  /// Adds what a direction changes of a part: `change` along the ground, what `along` says of what was before.
  template <class Along>
  SLIPWISE_LANES void add_change(std::size_t column, TangentLanes<L> change, const Part& part, const Along& along) {
    const Vector forward = change.forward;
    if constexpr (!kPlain) {
      if (job_.on_grade) {
        see_from_above<L>(plain_grade(part.any), change);
      }
    }
    change.forward = change.forward + along(part.tangent.forward);
    change.left = change.left + along(part.tangent.left);
    change.turn = change.turn + along(part.tangent.turn);
    if constexpr (!kPlain) {
      if (along_ground_) {
        const Vector direction = sign(part.any.driven.forward.value, Vector{} + kOne);
        rows_.put(rows_.way_row(column), direction * forward + along(part.travelled));
      }
    }
    add_step(column, change, part.by);
  }

  SLIPWISE_LANES void add_actuator(std::size_t i, const PartTangent<Scalar>& moved, const Robot& before,
                                   const Part& part) {
    const LanePart<Scalar>& numbers = *part.numbers;
    const bool speeds = (plan_.moved[i] & 1U) != 0;
    Vector v{}, omega{}, vy{};
    if (speeds) {
      v = move_channel(rows_.drive_row(i, 0), before.v, numbers.v, moved.v);
    }
    if ((plan_.moved[i] & 2U) != 0) {
      omega = move_channel(rows_.drive_row(i, 1), before.omega, numbers.omega, moved.omega);
    }
    if (job_.sharpest > 0) {
      omega = part.speed * omega + part.curvature * v;
    }
    if constexpr (!kPlain) {
      if (speeds && job_.vy != nullptr) {
        vy = move_channel(rows_.drive_row(i, 2), before.vy, numbers.v, moved.v);
      }
    }
    const Scalar longer = moved.duration / numbers.duration;  // is driven and slips in proportion
    const TangentLanes<Differentiable>& driven = part.any.driven;
    add_change(i, {driven.forward.value * longer, driven.left.value * longer, driven.turn.value * longer}, part,
               [&](const Wide& number) {
                 const Vector by_means = number.by[kMeanV] * v + number.by[kMeanOmega] * omega;
                 if constexpr (kPlain) {
                   return by_means;
                 } else {
                   const Vector all = by_means + number.by[kMeanVy] * vy;
                   return along_ground_ ? all + number.by[kHeading] * rows_.get(rows_.turn_row(i)) +
                                              number.by[kTravelled] * rows_.get(rows_.way_row(i)) +
                                              number.by[kDuration] * moved.duration
                                        : all;
                 }
               });
  }

  SLIPWISE_LANES static GradeLanes<L> plain_grade(const AnyPart<Differentiable>& any) {
    const GradeLanes<Differentiable>& grade = any.grade;
    return {grade.gx.value,     grade.gy.value,       grade.cos_pitch.value,
            grade.across.value, grade.cos_roll.value, grade.upward.value};
  }

  /// Columns of slip on level ground without edges: what they change does not depend on where the robot is.
  template <class Products>
  SLIPWISE_LANES void add_columns(const LanePart<Scalar>& part, const Products& products, const StepLanes<Vector>& by) {
    for (std::size_t column = plan_.actuator; column < plan_.columns; ++column) {
      for (std::size_t e = plan_.first_entry[column]; e < plan_.first_entry[column + 1]; ++e) {
        const TangentEntry<Scalar>& entry = plan_.entries[e];
        const Vector change = products(entry.product) * (entry.rate * part.duration);
        rows_.add(rows_.x_row(column), by.x[entry.channel] * change);
        rows_.add(rows_.y_row(column), by.y[entry.channel] * change);
        if (entry.channel == 2) {
          rows_.add(rows_.turn_row(column), change);
        }
      }
    }
  }
  SLIPWISE_LANES void add_columns_on_ground(const Part& part) {
    for (std::size_t column = plan_.actuator; column < plan_.columns; ++column) {
      Vector changes[3] = {};
      for (std::size_t e = plan_.first_entry[column]; e < plan_.first_entry[column + 1]; ++e) {
        const TangentEntry<Scalar>& entry = plan_.entries[e];
        Vector change = part.any.products.value[entry.product].value * (entry.rate * part.numbers->duration);
        if (entry.edge > 0) {
          change = change * part.any.beyond[entry.edge - 1].value;
        }
        changes[entry.channel] = changes[entry.channel] + change;
      }
      const Vector heading = rows_.get(rows_.turn_row(column)), travel = rows_.get(rows_.way_row(column));
      add_change(column, {changes[0], changes[1], changes[2]}, part,
                 [&](const Wide& number) { return number.by[kHeading] * heading + number.by[kTravelled] * travel; });
    }
  }

  SLIPWISE_LANES void add_noise(const LanePart<Scalar>& part, const MeanLanes<L>& mean, const StepLanes<Vector>& by) {
    const LaneNoise<Scalar>& noise = plan_.noise;
    MotionLanes<L> motion;
    find_motion<L>(noise, mean, job_.vy != nullptr, part.duration, motion);
    const std::size_t row = rows_.noise_row();
    SymmetricLanes<Vector> sum = white();
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector constant = motion.per_channel[c] * noise.fraction[c];
      rows_.add(row + 6 + 2 * c, by.x[c] * constant);
      rows_.add(row + 7 + 2 * c, by.y[c] * constant);
      const Vector turn_by = Vector{} + static_cast<Scalar>(c == 2 ? 1 : 0);
      add_square(by.x[c], by.y[c], turn_by, white_variance<L>(noise, motion, c), sum);
      rows_.add(row + 12, turn_by * constant);
    }
    const Vector sums[6] = {sum.xx, sum.xy, sum.yy, sum.xt, sum.yt, sum.tt};
    for (std::size_t e = 0; e < 6; ++e) {
      rows_.put(row + e, sums[e]);
    }
  }
  SLIPWISE_LANES SymmetricLanes<Vector> white() const {
    const std::size_t row = rows_.noise_row();
    return {rows_.get(row),     rows_.get(row + 1), rows_.get(row + 2),
            rows_.get(row + 3), rows_.get(row + 4), rows_.get(row + 5)};
  }
  /// What is not known of the columns: their derivatives times the factor, squared.
  SLIPWISE_LANES SymmetricLanes<Vector> of_columns() const {
    SymmetricLanes<Vector> sum{};
    const Scalar* factor = plan_.factor;
    for (std::size_t first = 0; first < plan_.columns; first += kColumnsTogether) {
      Vector x[kColumnsTogether] = {}, y[kColumnsTogether] = {}, turn[kColumnsTogether] = {};
      std::size_t column = first;
      for (; column < plan_.turning; ++column, factor += kColumnsTogether) {
        const Vector by_x = rows_.get(rows_.x_row(column)), by_y = rows_.get(rows_.y_row(column)),
                     by_turn = rows_.get(rows_.turn_row(column));
        for (std::size_t i = 0; i < kColumnsTogether; ++i) {
          x[i] = x[i] + by_x * factor[i];
          y[i] = y[i] + by_y * factor[i];
          turn[i] = turn[i] + by_turn * factor[i];
        }
      }
      for (; column < plan_.columns; ++column, factor += kColumnsTogether) {
        const Vector by_x = rows_.get(rows_.x_row(column)), by_y = rows_.get(rows_.y_row(column));
        for (std::size_t i = 0; i < kColumnsTogether; ++i) {
          x[i] = x[i] + by_x * factor[i];
          y[i] = y[i] + by_y * factor[i];
        }
      }
      for (std::size_t i = 0; i < kColumnsTogether; ++i) {
        first < plan_.turning ? add_square(x[i], y[i], turn[i], kOne, sum) : add_square(x[i], y[i], kOne, sum);
      }
    }
    for (std::size_t i = 0; i < plan_.disturbed_count; ++i) {
      const std::size_t column = plan_.disturbed[i];
      add_square(rows_.get(rows_.x_row(column)), rows_.get(rows_.y_row(column)), rows_.get(rows_.turn_row(column)),
                 plan_.disturbance[period_ * plan_.disturbed_count + i], sum);
    }
    return sum;
  }

  SLIPWISE_LANES void write(const PathLanes<L>& path) {
    const std::size_t row = rows_.noise_row() + 6;
    SymmetricLanes<Vector> noise = white();
    add_square(rows_.get(row), rows_.get(row + 1), kOne, noise);
    add_square(rows_.get(row + 2), rows_.get(row + 3), kOne, noise);
    add_square(rows_.get(row + 4), rows_.get(row + 5), rows_.get(row + 6), kOne, noise);
    carry_to<L>(path, noise);
    scale_along(start_cosine_, start_sine_, plan_.root, noise);  // the learned factors belong to the axes of the start
    SymmetricLanes<Vector> sum = of_columns();
    carry_to<L>(path, sum);
    const Vector entries[6] = {sum.xx + noise.xx, sum.xy + noise.xy, sum.yy + noise.yy,
                               sum.xt + noise.xt, sum.yt + noise.yt, sum.tt + noise.tt};
    Scalar* out = plan_.out + period_ * job_.rollouts + block_.first;
    for (std::size_t e = 0; e < 6; ++e, out += job_.periods / job_.pieces * job_.rollouts) {
      store_first(Vector(entries[e] * plan_.inflation[period_]), block_.count, out);
    }
  }

  const LaneJob<Scalar>& job_;
  const LaneBlock<Scalar>& block_;
  const LaneTangents<Scalar>& plan_;
  std::size_t period_ = 0;
  std::size_t last_piece_;  ///< of the period
  bool along_ground_;       ///< slip depends on where the robot is
  TangentRows<L> rows_;
  Vector start_cosine_, start_sine_;
};

template <class L, int kBy, typename Scalar = L::Scalar>
SLIPWISE_LANES_APART unsigned roll_tangents_by(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  RobotLanes<L, Actuator::Response, Slip::Any> robot;
  TangentRide<L, kBy> ride(job, block);
  ride_block<L, Actuator::Response, Slip::Any>(job, block, robot, ride);
  return find_faults<L, true>(robot.path, block) |
         (OutputLanes<L>(job, block).all_finite(robot.path) ? kNoFault : kNotFinite);
}

/// Rolls the block out with its tangents.
template <class Level, typename Scalar>
unsigned roll_tangents(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  using L = Lanes<Unpaired<Level>, Scalar>;
  const bool plain = !job.on_grade && job.edge_count == 0 && job.vy == nullptr;
  return plain ? roll_tangents_by<L, kPlainSeeds>(job, block) : roll_tangents_by<L, kSeeds>(job, block);
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
