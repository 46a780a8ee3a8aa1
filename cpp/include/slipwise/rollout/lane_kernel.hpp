// SPDX-License-Identifier: Apache-2.0
// The rollout of one block of lanes: command actuator, slip, exact steps, outputs. Compiled once per instruction level.
#pragma once

#include <cstdint>

#include "slipwise/lie/body_twist.hpp"
#include "slipwise/rollout/lane_actuator.hpp"
#include "slipwise/rollout/lane_ahead.hpp"
#include "slipwise/rollout/lane_grade.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lane_output.hpp"
#include "slipwise/rollout/lane_path.hpp"
#include "slipwise/rollout/lane_slip.hpp"
#include "slipwise/rollout/lanes.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// How slip is found: a program of products, one of second degree in speed and curvature (thesis 5.1), or products with
/// all that is rarer: a sideways speed, a drive that steers, gravity on a plane that is not level, and surfaces that
/// the robot comes to.
enum class Slip : std::uint8_t { Products, Quadratic, Any };

/// A robot in every lane: its drive and where it is.
template <class L, Actuator kActuator, Slip kSlip>
struct RobotLanes {
  ChannelLanes<L, kActuator> v;
  ChannelLanes<L, kActuator> omega;
  PathLanes<L> path;
};
template <class L, Actuator kActuator>
struct RobotLanes<L, kActuator, Slip::Any> {
  ChannelLanes<L, kActuator> v;
  ChannelLanes<L, kActuator> omega;
  ChannelLanes<L, kActuator> vy;
  PathLanes<L> path;
  L::Vector travelled;  ///< [m]
};

/// Whether some rollout turned by more than the kernel's steps can.
template <class L, bool kWide, typename Scalar = L::Scalar>
SLIPWISE_LANES unsigned find_faults(const PathLanes<L>& path, const LaneBlock<Scalar>& block) {
  constexpr double kWidest = kWide ? kWidestLaneTurn : kLaneTurn;
  alignas(64) Scalar squared[L::kLanes];
  store(path.widest_squared, squared);
  unsigned faults = kNoFault;
  for (std::size_t i = 0; i < lanes_in<L>(block); ++i) {
    faults |= squared[i] > static_cast<Scalar>(kWidest * kWidest) ? kTurnsTooFar : kNoFault;
  }
  return faults;
}

/// What slip over a part comes from, with all that is rarer.
template <class L>
struct AnyPart {
  ProductLanes<L> products;
  GradeLanes<L> grade;           ///< on a grade
  L::Vector beyond[kMostEdges];  ///< of each edge, the fraction of the part that lies there
  TangentLanes<L> driven;        ///< along the ground
};

/// What a part begins with. The duration is one number, or lanes.
template <class L, class Duration>
struct PartStart {
  HeadingLanes<L> heading;
  MeanLanes<L> mean;
  const L::Scalar* coefficients;
  Duration duration;
};

/// The tangent of a part with all that is rarer.
template <class L, class Duration, typename Scalar = L::Scalar>
SLIPWISE_LANES void any_tangent(const LaneJob<Scalar>& job, const PartStart<L, Duration>& from,
                                typename L::Vector& travelled, AnyPart<L>& part, TangentLanes<L>& tangent) {
  const MeanLanes<L>& mean = from.mean;
  if (job.on_grade) {
    find_grade<L>(job, from.heading, mean.omega * (from.duration * static_cast<Scalar>(0.5)), part.grade);
  }
  TangentLanes<L>& driven = part.driven;
  slip_tangent<L>(job, {from.coefficients, job.on_grade ? &part.grade : nullptr, job.vy != nullptr}, mean,
                  part.products, driven);
  const typename L::Vector length = magnitude(mean.v) * from.duration;
  for (std::size_t i = 0; i < job.edge_count; ++i) {
    TangentLanes<L> change;
    products_tangent<L>(job, from.coefficients + 3 * (i + 1) * job.product_count, part.products, change);
    find_beyond<L>(job.edges[i], travelled, length, part.beyond[i]);
    driven.forward = driven.forward + part.beyond[i] * change.forward;
    driven.left = driven.left + part.beyond[i] * change.left;
    driven.turn = driven.turn + part.beyond[i] * change.turn;
  }
  travelled = travelled + magnitude(driven.forward);
  copy(driven.forward, tangent.forward);
  copy(driven.left, tangent.left);
  copy(driven.turn, tangent.turn);
  if (job.on_grade) {
    see_from_above<L>(part.grade, tangent);
  }
}

/// The drive moves on over a part.
template <class L, Actuator kActuator, Slip kSlip, typename Scalar = L::Scalar>
SLIPWISE_LANES void move_drive(const LaneJob<Scalar>& job, const LanePart<Scalar>& part,
                               RobotLanes<L, kActuator, kSlip>& robot, MeanLanes<L>& mean) {
  advance<L, kActuator, true>(part.v, robot.v, mean.v);
  advance<L, kActuator, false>(part.omega, robot.omega, mean.omega);
  if constexpr (kSlip == Slip::Any) {
    if (job.sharpest > 0) {
      mean.omega = mean.v * mean.omega;
    }
    if (job.vy != nullptr) {
      advance<L, kActuator, true>(part.v, robot.vy, mean.vy);
    } else {
      fill(static_cast<Scalar>(0), mean.vy);
    }
  }
}

/// The tangent of one part, of which this is the drive's mean.
template <class L, Actuator kActuator, Slip kSlip, typename Scalar = L::Scalar>
SLIPWISE_LANES void slip_part(const LaneJob<Scalar>& job, const LanePart<Scalar>& part, const MeanLanes<L>& mean,
                              RobotLanes<L, kActuator, kSlip>& robot, TangentLanes<L>& tangent) {
  const Scalar* coefficients = job.coefficients + part.first_coefficient;
  if constexpr (kSlip == Slip::Quadratic) {
    quadratic_tangent<L>(job, coefficients, mean.v, mean.omega, tangent);
  } else if constexpr (kSlip == Slip::Products) {
    ProductLanes<L> products;
    slip_tangent<L>(job, {coefficients, nullptr, false}, mean, products, tangent);
  } else {
    AnyPart<L> any;
    const PartStart<L, Scalar> from{{robot.path.cosine, robot.path.sine}, mean, coefficients, part.duration};
    any_tangent<L>(job, from, robot.travelled, any, tangent);
  }
}

/// Where a block's commands are read from; vy where the robot drives sideways.
template <typename Scalar>
struct CommandSources {
  CommandSource<Scalar> v, omega, vy;
};

template <typename Scalar>
SLIPWISE_LANES CommandSources<Scalar> sources_of(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  const auto first = static_cast<std::ptrdiff_t>(block.first) * job.rollout_stride;
  return {{job.v + first, &block.v, &DriveCommand::v},
          {job.omega + first, &block.omega, &DriveCommand::omega},
          {job.vy + (job.vy != nullptr ? first : 0), &block.vy, &DriveCommand::vy}};
}

template <class L, Actuator kActuator, Slip kSlip, typename Scalar = L::Scalar>
SLIPWISE_LANES void start_robot(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                                const CommandSources<Scalar>& sources, RobotLanes<L, kActuator, kSlip>& robot) {
  start_channel(job, block, sources.v, job.shift_v, robot.v);
  start_channel(job, block, sources.omega, job.shift_omega, robot.omega);
  start_path<L>(block, robot.path);
  if constexpr (kSlip == Slip::Any) {
    if (job.sharpest > 0) {
      drop_standing_speed(static_cast<Scalar>(kStandingSpeed), robot.v.input);
      robot.omega.next = job.start_row - job.shift_omega - 1;
      tell_curvature(job, block, sources.v, sources.omega, robot.omega);
    }
    robot.vy.next = 0;
    if (job.vy != nullptr) {
      start_channel(job, block, sources.vy, job.shift_v, robot.vy);
    }
    fill(static_cast<Scalar>(0), robot.travelled);
  }
}

/// The next commands begin to act, where they do with this part.
template <class L, Actuator kActuator, Slip kSlip, typename Scalar = L::Scalar>
SLIPWISE_LANES void tell_robot(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                               const CommandSources<Scalar>& sources, const LanePart<Scalar>& part,
                               RobotLanes<L, kActuator, kSlip>& robot) {
  if (kActuator == Actuator::None || part.next_v) {
    tell(job, block, sources.v, robot.v);
    if constexpr (kSlip == Slip::Any) {
      if (job.sharpest > 0) {
        drop_standing_speed(static_cast<Scalar>(kStandingSpeed), robot.v.input);
      }
      if (job.vy != nullptr) {
        tell(job, block, sources.vy, robot.vy);
      }
    }
  }
  if (kActuator == Actuator::None || part.next_omega) {
    if (kSlip == Slip::Any && job.sharpest > 0) {
      tell_curvature(job, block, sources.v, sources.omega, robot.omega);
    } else {
      tell(job, block, sources.omega, robot.omega);
    }
  }
}

/// One loop over the parts of all periods, so that the robot stays in the processor's registers: at the branch the
/// robot is put aside, the tail leads it to the period's end, and it goes on from where it was put aside. `ride` drives
/// the robot over a part and writes what is wanted.
template <class L, Actuator kActuator, Slip kSlip, class Ride, typename Scalar = L::Scalar>
SLIPWISE_LANES void ride_block(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                               RobotLanes<L, kActuator, kSlip>& robot, Ride& ride) {
  const CommandSources<Scalar> sources = sources_of(job, block);
  start_robot<L, kActuator, kSlip>(job, block, sources, robot);
  ride.start(robot);
  RobotLanes<L, kActuator, kSlip> aside = robot;
  const bool has_tail = job.tail != job.part_end;
  std::size_t period = 0;
  for (std::size_t i = 0; period < job.periods;) {
    tell_robot<L, kActuator, kSlip>(job, block, sources, job.parts[i], robot);
    ride.drive(i, robot);
    if constexpr (kActuator == Actuator::None) {
      ride.write_period(robot.path, period);
      ++period;
      continue;
    }
    ++i;
    if (i == job.part_end) {
      ride.write_piece(robot.path, period);
      ++period;
      if (has_tail && period < job.periods) {
        robot = aside;
        ride.take_up();
        i = job.branch;
        continue;
      }
      i = job.cycle;
    } else if (i == job.tail) {
      i = job.cycle;
    }
    if (has_tail && i == job.branch) {
      if (ride.wants_piece(period) || period + 1 == job.periods) {
        aside = robot;
        ride.put_aside();
        i = job.tail;
      } else {
        ++period;
      }
    }
  }
}

/// The robot alone. `kWide` also takes steps that turn by more than kLaneTurn.
template <class L, Actuator kActuator, Slip kSlip, bool kWide>
class RobotRide : public OutputLanes<L> {
 public:
  using Scalar = L::Scalar;
  using Robot = RobotLanes<L, kActuator, kSlip>;

  SLIPWISE_LANES RobotRide(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block)
      : OutputLanes<L>(job, block), job_(job) {}

  SLIPWISE_LANES void start(const Robot& /*robot*/) const {}
  SLIPWISE_LANES void drive(std::size_t part, Robot& robot) const {
    MeanLanes<L> mean;
    move_drive<L, kActuator, kSlip>(job_, job_.parts[part], robot, mean);
    TangentLanes<L> tangent;
    slip_part<L, kActuator, kSlip>(job_, job_.parts[part], mean, robot, tangent);
    step<L, kWide>(tangent, robot.path);
  }
  SLIPWISE_LANES void put_aside() const {}
  SLIPWISE_LANES void take_up() const {}

 private:
  const LaneJob<Scalar>& job_;
};

/// Rolls the block out.
template <class L, Actuator kActuator, Slip kSlip, bool kWide, typename Scalar = L::Scalar>
SLIPWISE_LANES_APART unsigned roll_block_as(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  RobotLanes<L, kActuator, kSlip> robot;
  RobotRide<L, kActuator, kSlip, kWide> ride(job, block);
  ride_block<L, kActuator, kSlip>(job, block, robot, ride);
  ride.write_end(robot.path);
  return find_faults<L, kWide>(robot.path, block) | (ride.all_finite(robot.path) ? kNoFault : kNotFinite);
}

template <class L, Actuator kActuator, Slip kSlip, typename Scalar = L::Scalar>
unsigned roll_block_with(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  if constexpr (kSlip == Slip::Any) {  // rarer, and not worth kernels for both kinds of turns
    return roll_block_as<L, kActuator, kSlip, true>(job, block);
  }
  const unsigned fault = roll_block_as<L, kActuator, kSlip, false>(job, block);
  return (fault & kTurnsTooFar) == 0 ? fault : roll_block_as<L, kActuator, kSlip, true>(job, block);
}

/// What the job needs a kernel for.
template <typename Scalar>
SLIPWISE_LANES Actuator actuator_of(const LaneJob<Scalar>& job) {
  if (job.responds) {
    return Actuator::Response;
  }
  if (job.lags) {
    return Actuator::Lags;
  }
  return job.part_end == 1 && job.pieces == 1 ? Actuator::None : Actuator::Delays;
}

/// Whether it is one of the rarer jobs.
template <typename Scalar>
SLIPWISE_LANES bool needs_any(const LaneJob<Scalar>& job) {
  return job.on_grade || job.edge_count > 0 || job.vy != nullptr || job.sharpest > 0;
}

template <class Level, Slip kSlip, typename Scalar>
unsigned roll_block_of(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  using L = Lanes<Level, Scalar>;
  switch (actuator_of(job)) {
    case Actuator::Response:
      return roll_block_with<L, Actuator::Response, kSlip>(job, block);
    case Actuator::Lags:
      return roll_block_with<L, Actuator::Lags, kSlip>(job, block);
    case Actuator::None:
      if constexpr (Level::kSingleLoop) {
        return roll_block_with<L, Actuator::None, kSlip>(job, block);
      }
      break;
    case Actuator::Delays:
      break;
  }
  return roll_block_with<L, Actuator::Delays, kSlip>(job, block);
}

template <class Level, typename Scalar>
unsigned roll_block(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  if (needs_any(job)) {
    return roll_block_of<Level, Slip::Any>(job, block);
  }
  return job.is_quadratic ? roll_block_of<Level, Slip::Quadratic>(job, block)
                          : roll_block_of<Level, Slip::Products>(job, block);
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
