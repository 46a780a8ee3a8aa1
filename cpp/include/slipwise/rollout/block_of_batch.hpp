// SPDX-License-Identifier: Apache-2.0
// A batch as the kernels take it: the job of all its rollouts, and some neighbouring ones at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>

#include "slipwise/actuator/kinematics.hpp"
#include "slipwise/rollout/actuator_start.hpp"
#include "slipwise/rollout/lane_tangent_job.hpp"
#include "slipwise/rollout/limited_commands.hpp"
#include "slipwise/rollout/rollout_batch.hpp"
#include "slipwise/slip/term.hpp"

namespace slipwise {

template <typename Scalar>
LaneMap<Scalar> lane_map(const Costmap* map) {
  if (map == nullptr) {
    return {};
  }
  check_costmap(*map);
  return {.cells = map->cells.data(),
          .columns = map->columns,
          .width = static_cast<Scalar>(map->columns),
          .height = static_cast<Scalar>(map->rows),
          .per_metre = static_cast<Scalar>(1.0 / map->resolution),
          .outside = map->outside};
}

template <typename Scalar>
LaneJob<Scalar> job_of(const RolloutProgram& program, const RolloutBatch<Scalar>& batch,
                       const RolloutOutputs<Scalar>& outputs) {
  const LaneConstants<Scalar>& constants = program.constants<Scalar>();
  const ActuatorSchedule& actuator = program.actuator();
  LaneJob<Scalar> job{
      .parts = constants.parts.data(),
      .coefficients = constants.coefficients.data(),
      .cycle = actuator.lead_in.size(),
      .branch = actuator.lead_in.size() + actuator.branch,
      .tail = actuator.lead_in.size() + actuator.cycle.size(),
      .part_end = constants.parts.size(),
      .products = program.products().data(),
      .product_count = program.products().size(),
      .is_quadratic = program.quadratic().has_value(),
      .quadratic = program.quadratic().value_or(LaneQuadratic{}),
      .factors = program.slip().factors,
      .squared_curvature_speed = static_cast<Scalar>(kCurvatureSpeed * kCurvatureSpeed),
      .on_grade = program.setting().on_grade(),
      .rise_x = static_cast<Scalar>(program.setting().rise_x),
      .rise_y = static_cast<Scalar>(program.setting().rise_y),
      .minus_gravity = static_cast<Scalar>(-kStandardGravity),
      .edge_count = program.setting().ahead.edges.size(),
      .edges = {},
      .sharpest = static_cast<Scalar>(actuator.wheelbase > 0.0 ? sharpest_curvature(actuator.wheelbase) : 0.0),
      .shift_v = actuator.v.shift,
      .shift_omega = actuator.omega.shift,
      .lags = actuator.lags,
      .responds = actuator.responds,
      .limits = program.limited() ? &constants.limits : nullptr,
      .pieces = program.pieces(),
      .start_row = 0,
      .last_row = static_cast<std::ptrdiff_t>(batch.periods) - 1,
      .rollouts = batch.rollouts,
      .periods = batch.periods,
      .v = batch.commands.v,
      .omega = batch.commands.omega,
      .vy = batch.commands.vy,
      .rollout_stride = batch.commands.rollout_stride,
      .period_stride = batch.commands.period_stride,
      .path = {outputs.x, outputs.y, outputs.theta},
      .end = {outputs.end_x, outputs.end_y, outputs.end_theta},
      .map = lane_map<Scalar>(outputs.map),
      .cost_sum = outputs.cost_sum,
      .cost_highest = outputs.cost_highest,
      .cost_lowest = outputs.cost_lowest,
      .tangents = nullptr,
      .futures = nullptr};
  for (std::size_t i = 0; i < job.edge_count; ++i) {
    job.edges[i] = static_cast<Scalar>(program.setting().ahead.edges[i]);
  }
  return job;
}

/// The commands of one channel of one rollout, those sent before the start with negative numbers.
template <typename Scalar>
struct SentCommands {
  const RolloutBatch<Scalar>& batch;
  std::size_t rollout;
  std::span<const DriveCommand> past;
  const Scalar* commands;
  double DriveCommand::* channel;

  double operator()(std::ptrdiff_t i) const {
    if (i < 0) {
      return past[static_cast<std::size_t>(std::max(static_cast<std::ptrdiff_t>(past.size()) + i, std::ptrdiff_t{0}))].*
             channel;
    }
    const std::ptrdiff_t period = std::min(i, static_cast<std::ptrdiff_t>(batch.periods) - 1);
    return static_cast<double>(commands[static_cast<std::ptrdiff_t>(rollout) * batch.commands.rollout_stride +
                                        period * batch.commands.period_stride]);
  }
};

/// The first period of commands that no pose depends on, since they are still in the delay at the end.
template <typename Scalar>
std::size_t first_unused(const LaneJob<Scalar>& job) {
  const auto pieces = static_cast<std::ptrdiff_t>(job.pieces);
  const std::ptrdiff_t unused = (std::max({job.shift_v, job.shift_omega, std::ptrdiff_t{0}}) + pieces - 1) / pieces;
  return static_cast<std::size_t>(std::max(static_cast<std::ptrdiff_t>(job.periods) - unused, std::ptrdiff_t{0}));
}

/// Whether what a drive holds at the start hangs on commands that are sent later.
inline bool hangs_on_commands(const ActuatorSchedule& actuator) {
  return (actuator.responds || actuator.wheelbase > 0.0) && std::min(actuator.v.shift, actuator.omega.shift) < 0;
}

/// Where the derivatives of the drives at the start go: by these of the actuator's parameters.
template <typename Scalar>
struct StartDerivatives {
  const ActuatorScheduleOf<ActuatorDual>* actuator = nullptr;  ///< null where none are wanted
  std::span<const int> places = {};
  StartTangent<Scalar>* rows = nullptr;  ///< [places]
};

/// Moves the block to its place in the batch. What all lanes fraction is set once.
template <typename Scalar>
class BlockOfBatch {
 public:
  BlockOfBatch(const RolloutProgram& program, const RolloutBatch<Scalar>& batch, const Costmap* map,
               const LaneKernelOfLevel<Scalar>& kernel, const LaneJob<Scalar>& job)
      : commands_(program, kernel, job),
        program_(program),
        actuator_(program.actuator()),
        batch_(batch),
        map_(map),
        lanes_(kernel.lanes),
        many_(batch.starts.size() > 1),
        each_(many_ || hangs_on_commands(actuator_)) {
    point_to_rows(rows_.data(), kMostLanes, block_);
    block_.past_count = batch.past.size() / batch.starts.size();
    block_.past_stride = many_ ? block_.past_count : 0;
    set_lanes(0, kMostLanes, 0);
  }

  /// Where derivatives of the starts go.
  void differentiate(const StartDerivatives<Scalar>& derivatives) {
    derivatives_ = derivatives;
    set_lanes(0, kMostLanes, 0);
  }

  /// Whether some rollouts start differently from others.
  bool differs() const { return each_; }

  /// Drives one block; returns its faults.
  unsigned roll(std::size_t block) {
    at(block);
    return commands_.roll(block_);
  }

  const LaneBlock<Scalar>& at(std::size_t block) {
    block_.first = block * lanes_;
    block_.count = std::min(lanes_, batch_.rollouts - block_.first);
    block_.side_by_side = batch_.commands.rollout_stride == 1 && block_.count == lanes_;
    block_.past = batch_.past.data() + (many_ ? block_.first * block_.past_count : 0);
    for (std::size_t lane = 0; each_ && lane < block_.count; ++lane) {
      set_lanes(lane, lane + 1, block_.first + lane);
    }
    return block_;
  }

 private:
  template <typename T>
  struct Drives {
    ActuatorStartOf<T> v, omega, vy;
  };

  std::span<const DriveCommand> past_of(std::size_t rollout) const {
    return batch_.past.subspan(many_ ? rollout * block_.past_count : 0, block_.past_count);
  }

  double sent(std::size_t rollout, std::ptrdiff_t i, double DriveCommand::* channel) const {
    const CommandView<Scalar>& all = batch_.commands;
    const Scalar* commands = channel == &DriveCommand::v ? all.v : channel == &DriveCommand::vy ? all.vy : all.omega;
    return SentCommands<Scalar>{batch_, rollout, past_of(rollout), commands, channel}(i);
  }

  /// `command(i, channel)` is what was sent in period i of the actuator, from `known_before` periods before the start
  /// on.
  template <typename T, typename Command>
  Drives<T> drives_of(const ActuatorScheduleOf<T>& actuator, std::size_t rollout, std::size_t known_before,
                      const Command& command) const {
    const DriveCommand& now = batch_.starts[many_ ? rollout : 0].drive;
    const auto channel = [&](const ChannelTimingOf<T>& timing, double DriveCommand::* member) {
      return actuator_start(actuator, timing, now.*member, -static_cast<std::ptrdiff_t>(known_before),
                            [&](std::ptrdiff_t i) { return command(i, member); });
    };
    return {.v = channel(actuator.v, &DriveCommand::v),
            .omega = actuator.wheelbase > 0.0 ? steering_of(actuator, now, known_before, command)
                                              : channel(actuator.omega, &DriveCommand::omega),
            .vy = program_.sideways() ? channel(actuator.v, &DriveCommand::vy) : ActuatorStartOf<T>{}};
  }

  /// The channel of the curvature: it has followed the commands; without any, the drive shows it, if it is fast enough.
  template <typename T, typename Command>
  static ActuatorStartOf<T> steering_of(const ActuatorScheduleOf<T>& actuator, const DriveCommand& now,
                                        std::size_t known_before, const Command& command) {
    const double wheelbase = actuator.wheelbase;
    const BodyTwist drive{.v = now.v, .vy = 0.0, .omega = now.omega};
    const auto oldest = -static_cast<std::ptrdiff_t>(known_before);
    const auto curvature = [&](std::ptrdiff_t i) {
      return curvature_of({.v = command(i, &DriveCommand::v), .omega = command(i, &DriveCommand::omega)}, wheelbase);
    };
    return known_before == 0 && value_of(acts_at(actuator.omega, actuator.period, 0)) >= 0.0 && shows_curvature(drive)
               ? actuator_start(actuator, actuator.omega, curvature_of(drive, wheelbase), oldest, curvature)
               : followed_start(actuator, actuator.omega, oldest, curvature);
  }

  /// Adds what the limits give from the start on, as far as a drive hangs on it that acts early.
  void add_early_pieces(std::size_t rollout, LimitedStart& start) const {
    for (std::ptrdiff_t i = 0; each_ && i <= -std::min(actuator_.v.shift, actuator_.omega.shift); ++i) {
      DriveCommand command{.v = sent(rollout, i, &DriveCommand::v), .omega = sent(rollout, i, &DriveCommand::omega)};
      command.vy = program_.sideways() ? sent(rollout, i, &DriveCommand::vy) : 0.0;
      add_pieces(program_, command, start);
    }
  }

  /// Lanes from `first` to `last` start as this rollout does.
  void set_lanes(std::size_t first, std::size_t last, std::size_t rollout) {
    if (!program_.limited()) {
      set_drives(first, last, rollout, block_.past_count,
                 [&](std::ptrdiff_t i, auto member) { return sent(rollout, i, member); });
      return;
    }
    const DriveCommand& now = batch_.starts[many_ ? rollout : 0].drive;
    LimitedStart start = limited_start(program_, past_of(rollout),
                                       {.v = actuator_.v.response.keeping_input(now.v),
                                        .omega = actuator_.omega.response.keeping_input(now.omega),
                                        .vy = actuator_.v.response.keeping_input(now.vy)});
    for (std::size_t lane = first; lane < last; ++lane) {
      commands_.set_start(lane, start);
    }
    const auto before = static_cast<std::ptrdiff_t>(start.given.size());
    add_early_pieces(rollout, start);
    set_drives(first, last, rollout, block_.past_count * program_.pieces(), [&](std::ptrdiff_t i, auto member) {
      return start.given[static_cast<std::size_t>(std::max(before + i, std::ptrdiff_t{0}))].*member;
    });
  }

  template <typename Command>
  void set_drives(std::size_t first, std::size_t last, std::size_t rollout, std::size_t known_before,
                  const Command& command) {
    const Drives<double> drives = drives_of(actuator_, rollout, known_before, command);
    for (std::size_t lane = first; lane < last; ++lane) {
      set_lane(lane, batch_.starts[many_ ? rollout : 0].pose, drives);
    }
    if (derivatives_.actuator != nullptr) {
      set_derivatives(first, last, drives_of(*derivatives_.actuator, rollout, known_before, command));
    }
  }

  void set_derivatives(std::size_t first, std::size_t last, const Drives<ActuatorDual>& drives) {
    for (std::size_t i = 0; i < derivatives_.places.size(); ++i) {
      const int place = derivatives_.places[i];
      std::size_t c = 0;
      for (const auto* channel : {&drives.v, &drives.omega, &drives.vy}) {
        auto& by = derivatives_.rows[i].by[c++];
        for (std::size_t lane = first; lane < last; ++lane) {
          by[0][lane] = static_cast<Scalar>(channel->commanded.by[place]);
          by[1][lane] = static_cast<Scalar>(channel->fast.by[place]);
          by[2][lane] = static_cast<Scalar>(channel->slow.by[place]);
        }
      }
    }
  }

  void set_lane(std::size_t lane, const Pose2& pose, const Drives<double>& drives) {
    const auto number = [](double value) { return static_cast<Scalar>(value); };
    block_.x[lane] = number(pose.x);
    block_.y[lane] = number(pose.y);
    block_.theta[lane] = number(pose.theta);
    block_.cosine[lane] = number(std::cos(pose.theta));
    block_.sine[lane] = number(std::sin(pose.theta));
    if (map_ != nullptr) {
      block_.cell_x[lane] = number((pose.x - map_->origin_x) / map_->resolution);
      block_.cell_y[lane] = number((pose.y - map_->origin_y) / map_->resolution);
    }
    const auto set_channel = [&](LaneStart<Scalar>& channel, const ActuatorStart& drive) {
      channel.commanded[lane] = number(drive.commanded);
      channel.fast[lane] = number(drive.fast);
      channel.slow[lane] = number(drive.slow);
    };
    set_channel(block_.v, drives.v);
    set_channel(block_.omega, drives.omega);
    set_channel(block_.vy, drives.vy);
  }

  alignas(64) std::array<Scalar, kStartRows * kMostLanes> rows_{};
  LimitedCommands<Scalar> commands_;
  const RolloutProgram& program_;
  const ActuatorSchedule& actuator_;
  const RolloutBatch<Scalar>& batch_;
  const Costmap* map_;
  std::size_t lanes_;
  StartDerivatives<Scalar> derivatives_{};
  LaneBlock<Scalar> block_{};
  bool many_;  ///< starts
  bool each_;  ///< lane differs
};

[[noreturn]] inline void refuse(unsigned fault) {
  if ((fault & kTurnsTooFar) != 0) {
    throw std::invalid_argument(
        "a rollout turns thousands of times within one period; use shorter periods, or "
        "commands in rad/s");
  }
  throw std::invalid_argument("a rollout leaves the range of its numbers; are the commands finite, in m/s and rad/s?");
}

}  // namespace slipwise
