// SPDX-License-Identifier: Apache-2.0
// Compiling a motion model for rollouts.
#include "slipwise/rollout/rollout_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>

#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

constexpr double kSteepest = std::numbers::sqrt3 + 1e-9;  // rise per metre at 60 degrees

/// Gravity that is constant along the robot's axes; without one it turns with the heading.
std::optional<std::array<double, 2>> constant_gravity(const RolloutSetting& setting) {
  return setting.on_grade() ? std::nullopt : std::optional(std::array{setting.gx, setting.gy});
}

/// Where slip depends on a sideways speed, commands have one.
RolloutSetting with_axes(const MotionModel& model, const RolloutSetting& setting) {
  RolloutSetting known = setting;
  known.sideways = setting.sideways || model.basis().sideways();
  return known;
}

SlipProgram slip_of(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                    const RolloutSetting& setting) {
  model.check(parameters);
  if (!std::isfinite(setting.gx) || !std::isfinite(setting.gy)) {
    throw std::invalid_argument("the gravity along the robot's axes must be finite");
  }
  if (model.learned().wheelbase > 0.0 && (!unlimited(setting.limits) || setting.sideways)) {
    throw std::invalid_argument("a drive that steers has no limits of yaw rates and no sideways speed; leave them out");
  }
  const double steepness = std::hypot(setting.rise_x, setting.rise_y);
  if (!(steepness <= kSteepest)) {
    throw std::invalid_argument("the ground must not be steeper than 60 degrees");
  }
  if (setting.on_grade() && (setting.gx != 0.0 || setting.gy != 0.0)) {
    throw std::invalid_argument("give the gravity along the robot's axes or the ground's grade, not both");
  }
  const Eigen::VectorXd alpha = parameters.head(model.slip_size());
  return compile_slip(model.basis(), {alpha.data(), model.basis().size()}, constant_gravity(setting), setting.sideways);
}

std::vector<SlipProgram> changes_of(const MotionModel& model, const RolloutSetting& setting) {
  check_ahead(setting.ahead, model.slip_size());
  std::vector<SlipProgram> changes;
  for (const Eigen::VectorXd& change : setting.ahead.changes) {
    changes.push_back(slip_change(model, change, setting));
  }
  return changes;
}

std::vector<LaneProduct> lane_products(const SlipProgram& program, const std::vector<SlipProgram>& changes) {
  std::vector<LaneProduct> products;
  for (const SlipProduct& product : program.products) {
    unsigned channels = 0;
    for (unsigned c = 0; c < product.fraction.size(); ++c) {
      channels |= product.fraction[c] != 0.0 ? 1U << c : 0U;
      for (const SlipProgram& change : changes) {
        channels |= change.products[products.size()].fraction[c] != 0.0 ? 1U << c : 0U;
      }
    }
    products.push_back({static_cast<std::uint8_t>(product.parent), static_cast<std::uint8_t>(product.factor),
                        static_cast<std::uint8_t>(channels)});
  }
  return products;
}

/// In the numbers of a kernel. What is left of a gap is rounded first, so that a lag settles on its input.
template <typename Scalar>
LaneLag<Scalar> rounded_lag(const ChannelFractionOf<double>& part, const AxisResponse& response) {
  const auto number = [](double value) { return static_cast<Scalar>(value); };
  const auto rounded = [&](const LagFractionOf<double>& lag) {
    return LagFractionOf<double>{static_cast<double>(number(lag.mean_gap)), static_cast<double>(number(lag.end_gap))};
  };
  const LaneLag<double> lag = lane_lag<double>({rounded(part.fast), rounded(part.slow)}, response);
  return {number(lag.mean_by_input), number(lag.mean_by_fast),  number(lag.mean_by_slow), number(lag.fast_by_input),
          number(lag.fast_by_fast),  number(lag.slow_by_input), number(lag.slow_by_slow)};
}

/// Pieces of equal length, so that neither they nor what is sent before the start depends on any command.
std::size_t pieces_of(const RolloutSetting& setting) {
  check(setting.limits);
  const bool periods = setting.period > 0.0 && std::isfinite(setting.period);  // else the schedule says what is wrong
  return periods && limits_rates(setting.limits) ? static_cast<std::size_t>(ramp_pieces(setting.period)) : 1;
}

template <typename Scalar>
RampLimits<Scalar> ramp_limits(const AxisLimits& limits, double piece) {
  const auto number = [](double value) {
    return static_cast<Scalar>(std::min(value, static_cast<double>(std::numeric_limits<Scalar>::max())));
  };
  const double slew_rate_up = limits.slew_rate_up * piece;
  const double slew_rate_down = limits.slew_rate_down * piece;
  const double closes = LagDecay(limits.slew_rate_lag, piece).gone;
  return {.dead_band = number(limits.dead_band),
          .saturation = number(limits.saturation),
          .slew_rate_up = number(slew_rate_up),
          .slew_rate_down = number(slew_rate_down),
          .per_slew_up = number(1.0 / slew_rate_up),
          .per_slew_down = number(1.0 / slew_rate_down),
          .closes = number(closes),
          .per_closes = number(1.0 / closes),
          .ramps = limits_rates(limits),
          .lags = limits.slew_rate_lag > 0.0};
}

template <typename Scalar>
DriveRamps<Scalar> drive_ramps(const CommandLimits& limits, double piece) {
  return {.speed = ramp_limits<Scalar>(limits.speed, piece),
          .yaw_rate = ramp_limits<Scalar>(limits.yaw_rate, piece),
          .side = ramp_limits<Scalar>(limits.side, piece),
          .gain_v = static_cast<Scalar>(limits.gain_v),
          .half_separation = static_cast<Scalar>(0.5 * limits.gain_omega * limits.wheel_separation),
          .per_separation = static_cast<Scalar>(1.0 / limits.wheel_separation),
          .sides = limits_sides(limits)};
}

template <typename Scalar>
LaneConstants<Scalar> lane_constants(const SlipProgram& slip, const std::vector<SlipProgram>& changes,
                                     const ActuatorSchedule& actuator, const CommandLimits& limits) {
  LaneConstants<Scalar> constants{
      .parts = {}, .coefficients = {}, .limits = drive_ramps<Scalar>(limits, actuator.period)};
  std::vector<PeriodPart> parts = actuator.lead_in;
  parts.insert(parts.end(), actuator.cycle.begin(), actuator.cycle.end());
  parts.insert(parts.end(), actuator.tail.begin(), actuator.tail.end());
  for (const PeriodPart& part : parts) {
    constants.parts.push_back({.first_coefficient = constants.coefficients.size(),
                               .duration = static_cast<Scalar>(part.duration),
                               .v = rounded_lag<Scalar>(part.v, actuator.v.response),
                               .omega = rounded_lag<Scalar>(part.omega, actuator.omega.response),
                               .next_v = part.next_v,
                               .next_omega = part.next_omega});
    const auto add = [&](const SlipProgram& program) {
      for (const SlipProduct& product : program.products) {
        for (const double fraction : product.fraction) {
          constants.coefficients.push_back(static_cast<Scalar>(fraction * part.duration));
        }
      }
    };
    add(slip);
    std::ranges::for_each(changes, add);
  }
  return constants;
}

}  // namespace

SlipProgram slip_change(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& change,
                        const RolloutSetting& setting) {
  const Eigen::VectorXd alpha = change;
  SlipProgram program =
      compile_slip(model.basis(), {alpha.data(), model.basis().size()}, constant_gravity(setting), setting.sideways);
  program.products[kProductV].fraction[0] -= 1.0;
  program.products[kProductOmega].fraction[2] -= 1.0;
  if (setting.sideways) {
    program.products[kProductSideV].fraction[1] -= 1.0;
  }
  return program;
}

RolloutProgram::RolloutProgram(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                               const RolloutSetting& setting)
    : setting_(with_axes(model, setting)),
      slip_(slip_of(model, parameters, setting_)),
      changes_(changes_of(model, setting_)),
      pieces_(pieces_of(setting)),
      actuator_(schedule_actuator(model.actuator(parameters), setting.period / static_cast<double>(pieces_))),
      quadratic_(find_quadratic(slip_)),
      products_(lane_products(slip_, changes_)),
      float_(lane_constants<float>(slip_, changes_, actuator_, setting.limits)),
      double_(lane_constants<double>(slip_, changes_, actuator_, setting.limits)) {}

}  // namespace slipwise
