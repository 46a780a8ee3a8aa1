// SPDX-License-Identifier: Apache-2.0
// A Student t likelihood of wheel speeds of a limited drive, and its descent.
#include "slipwise/identify/limited_actuator_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slipwise/actuator/actuator_output.hpp"
#include "slipwise/identify/limited_actuator_parameters.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kDof = 4.0;          // of the residuals
constexpr double kLeastScale = 1e-3;  // [m/s, rad/s]; encoders are no finer
constexpr int kScaleSteps = 6;        // of finding the likeliest scale
constexpr double kDifference = 1e-2;  // of parameters, for derivatives; the pieces of ramps make smaller ones rough
constexpr double kMostInflation = 100.0;
constexpr double kSecondsAlike = 1.0;  // residuals further apart are taken as independent
constexpr int kOutputs = 2;
constexpr int kAttempts = 6;              // of a step, each shorter, on average
constexpr double kLeastPrecision = 1e-9;  // of a parameter that nothing tells of
constexpr double kLongestStep = 0.7;      // of a parameter

/// The likeliest scale of Student t residuals.
double likeliest_scale(const Eigen::Ref<const Eigen::VectorXd>& residual) {
  double squared = std::max(residual.squaredNorm() / static_cast<double>(residual.size()), kLeastScale * kLeastScale);
  for (int i = 0; i < kScaleSteps; ++i) {
    const auto r2 = residual.array().square();
    squared *= (kDof + 1.0) * (r2 / (kDof * squared + r2)).mean();
    squared = std::max(squared, kLeastScale * kLeastScale);
  }
  return std::sqrt(squared);
}

/// The sum of log(1 + x) of numbers from 0 to about 1e30, with one logarithm for each few.
double sum_of_logs(const Eigen::ArrayXd& x) {
  constexpr Eigen::Index kTogether = 8;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < x.size(); i += kTogether) {
    sum += std::log((1.0 + x.segment(i, std::min(kTogether, x.size() - i))).prod());
  }
  return sum;
}

/// By how much residuals that are alike overstate the evidence, from the derivatives of their log likelihoods.
double inflation_of(const Eigen::ArrayXd& score) {
  const double alike = (score.tail(score.size() - 1) * score.head(score.size() - 1)).sum() / score.square().sum();
  return std::clamp((1.0 + alike) / (1.0 - alike), 1.0, kMostInflation);
}

LimitedAxis axis_of_channel(int c) { return c == 0 ? LimitedAxis::Speed : LimitedAxis::YawRate; }

ActuatorAxis axis_of(const ActuatorModel& actuator, int c) {
  return c == 0 ? speed_axis(actuator) : yaw_rate_axis(actuator);
}

double gain_at_sides(const CommandLimits& limits, int c) { return c == 0 ? limits.gain_v : limits.gain_omega; }

void add_to(ActuatorLoss& loss, const ActuatorLoss& of_channel) {
  loss.total += of_channel.total;
  loss.inflation = std::max(loss.inflation, of_channel.inflation);
}

double chi(double value, double std) { return (value / std) * (value / std); }

AxisLimits CommandLimits::* member_of(LimitedAxis axis) {
  switch (axis) {
    case LimitedAxis::Speed:
      return &CommandLimits::speed;
    case LimitedAxis::YawRate:
      return &CommandLimits::yaw_rate;
    default:
      return &CommandLimits::side;
  }
}

}  // namespace

double& limit_of(AxisLimits& limits, LimitKind kind) { return limits.*row_of(kind).value; }

double limit_of(const AxisLimits& limits, LimitKind kind) { return limits.*row_of(kind).value; }

bool limits_anything(const AxisLimits& limits, LimitKind kind) {
  return limit_of(limits, kind) != limit_of(AxisLimits{}, kind);
}

AxisLimits& axis_of(CommandLimits& limits, LimitedAxis axis) { return limits.*member_of(axis); }

const AxisLimits& axis_of(const CommandLimits& limits, LimitedAxis axis) { return limits.*member_of(axis); }

double speed_of_side(const CommandLimits& limits, const SideCommand& command) {
  return std::abs(limits.gain_v * command.v + 0.5 * limits.gain_omega * command.omega * limits.wheel_separation);
}

CommandLimits acting_limits(const LimitedActuator& drive) {
  CommandLimits limits = drive.limits;
  const double v = drive.actuator.time_constant_v, omega = drive.actuator.time_constant_omega;
  const std::array lags{v, omega, 0.5 * (v + omega)};  // both sides move the drive ahead and turn it
  for (std::size_t k = 0; k < kLimitedAxes.size(); ++k) {
    AxisLimits& axis = axis_of(limits, kLimitedAxes.at(k));
    axis.slew_rate_lag = drive.rates_behind_lag && limits_rates(axis) ? lags.at(k) : 0.0;
  }
  return limits;
}

LimitedActuatorFit::LimitedActuatorFit(std::span<const WheelRecord> records, const PriorSettings& prior,
                                       double wheel_separation)
    : records_(records), prior_(prior), wheel_separation_(wheel_separation) {
  for (const WheelRecord& record : records) {
    samples_ += record.t.empty() ? 0 : record.t.size() - 1;
  }
}

LimitedActuator LimitedActuatorFit::start() const {
  LimitedActuator drive;
  drive.limits.wheel_separation = wheel_separation_;
  drive.actuator.time_constant_v = drive.actuator.time_constant_omega = prior_.time_constant;
  drive.actuator.delay_v = drive.actuator.delay_omega = prior_.delay;
  return drive;
}

LimitedActuatorFit::AxisActuator LimitedActuatorFit::channel_drive(const LimitedActuator& drive, int c) {
  const ActuatorAxis axis = axis_of(drive.actuator, c);
  return {axis_of(acting_limits(drive), axis_of_channel(c)), gain_at_sides(drive.limits, c),
          axis.response.time_constant, axis.delay};
}

const std::vector<InputHistory>& LimitedActuatorFit::inputs_of(const CommandLimits& limits, int c) const {
  CommandLimits acting = limits;
  if (!limits_sides(limits)) {
    acting = {};
    axis_of(acting, axis_of_channel(c)) = axis_of(limits, axis_of_channel(c));
  }
  if (last_.inputs.empty() || acting != last_.limits) {
    last_ = {acting, {}};
    for (const WheelRecord& record : records_) {
      last_.inputs.push_back(limited_inputs(record.commands, acting));
    }
  }
  return last_.inputs;
}

void LimitedActuatorFit::put_errors(const LimitedActuator& drive, std::span<const InputHistory> inputs, int c,
                                    Eigen::Ref<Eigen::VectorXd> errors) const {
  ActuatorAxis axis = axis_of(drive.actuator, c);
  if (!limits_sides(drive.limits)) {
    axis.response.gain = gain_at_sides(drive.limits, c);
  }
  std::vector<double> output;
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const WheelRecord& record = records_[k];
    output.resize(record.t.size());
    axis_speeds(inputs[k], axis, {.fast = record.wheels.front().*axis.part, .slow = 0.0}, record.t, output);
    for (std::size_t i = 1; i < record.t.size(); ++i, ++row) {
      errors[row] = record.wheels[i].*axis.part - output[i];
    }
  }
}

LimitedActuatorFit::FittedChannel LimitedActuatorFit::fitted_channel(const LimitedActuator& drive, int c) const {
  const auto rows = static_cast<Eigen::Index>(samples_);
  FittedChannel fit{.inputs = inputs_of(acting_limits(drive), c),
                    .error = Eigen::VectorXd(rows),
                    .scale = 0.0,
                    .weight = {},
                    .loss = {}};
  put_errors(drive, fit.inputs, c, fit.error);
  fit.scale = likeliest_scale(fit.error);
  const Eigen::ArrayXd scaled = fit.error.array() / fit.scale;
  const Eigen::ArrayXd over_dof = scaled.square() / kDof;
  fit.weight = (1.0 + 1.0 / kDof) / (1.0 + over_dof);
  fit.loss.total = 2.0 * static_cast<double>(rows) * std::log(fit.scale) + (kDof + 1.0) * sum_of_logs(over_dof);
  fit.loss.inflation = inflation_of(fit.weight.array() * scaled);
  return fit;
}

LimitedActuatorFit::FittedActuator LimitedActuatorFit::fitted(const LimitedActuator& drive) const {
  FittedActuator fit{{.drive = drive, .loss = {.total = prior_loss(drive), .inflation = 1.0}},
                     {fitted_channel(drive, 0), fitted_channel(drive, 1)}};
  for (const FittedChannel& channel : fit.channels) {
    add_to(fit.loss, channel.loss);
  }
  return fit;
}

ScoredActuator LimitedActuatorFit::scored(const LimitedActuator& drive) const {
  ScoredActuator result{.drive = drive, .loss = {.total = prior_loss(drive), .inflation = 1.0}};
  for (int c = 0; c < kOutputs; ++c) {
    add_to(result.loss, limits_sides(drive.limits) ? fitted_channel(drive, c).loss : known_loss(drive, c));
  }
  return result;
}

ActuatorLoss LimitedActuatorFit::known_loss(const LimitedActuator& drive, int c) const {
  auto& known = known_.at(static_cast<std::size_t>(c));
  const AxisActuator its = channel_drive(drive, c);
  const auto found = known.find(its);
  return found != known.end() ? found->second : known[its] = fitted_channel(drive, c).loss;
}

double LimitedActuatorFit::prior_loss(const LimitedActuator& drive) const {
  const ActuatorModel& actuator = drive.actuator;
  return chi(drive.limits.gain_v - 1.0, prior_.gain_std) + chi(drive.limits.gain_omega - 1.0, prior_.gain_std) +
         chi(std::log(actuator.time_constant_v / prior_.time_constant), prior_.log_std) +
         chi(std::log(actuator.time_constant_omega / prior_.time_constant), prior_.log_std) +
         chi(std::log(actuator.delay_v / prior_.delay), prior_.log_std) +
         chi(std::log(actuator.delay_omega / prior_.delay), prior_.log_std) +
         chi(std::log(drive.limits.wheel_separation / wheel_separation_), kSeparationLogStd);
}

LimitedActuatorFit::Slopes LimitedActuatorFit::derivatives(const FittedActuator& at,
                                                           const std::vector<int>& free) const {
  const LimitedActuator& drive = at.drive;
  const LimitParameters p = parameters_of(drive);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(samples_), std::ssize(free));
  Slopes derivatives{none, none};
  for (Eigen::Index k = 0; k < none.cols(); ++k) {
    const int parameter = free[static_cast<std::size_t>(k)];
    LimitParameters moved = p;
    moved[parameter] += kDifference;
    const LimitedActuator other = with_parameters(drive, moved);
    const bool behind = acts_behind(parameter, drive);
    for (std::size_t c = 0; c < derivatives.size(); ++c) {
      const int channel = static_cast<int>(c);
      if (acts_on(parameter, drive, channel)) {
        const FittedChannel& now = at.channels.at(c);
        auto derivative = derivatives.at(c).col(k);
        put_errors(other, behind ? now.inputs : inputs_of(acting_limits(other), channel), channel, derivative);
        derivative = (now.error - derivative) / kDifference;
      }
    }
  }
  return derivatives;
}

NormalEquations LimitedActuatorFit::equations(const FittedActuator& at, const std::vector<int>& free) const {
  const auto size = std::ssize(free);
  NormalEquations equations{.information = kLeastPrecision * Eigen::MatrixXd::Identity(size, size),
                            .gradient = Eigen::VectorXd::Zero(size)};
  const Slopes all = derivatives(at, free);
  for (std::size_t c = 0; c < all.size(); ++c) {
    const FittedChannel& channel = at.channels.at(c);
    const Eigen::MatrixXd& derivative = all.at(c);
    const Eigen::VectorXd weight = channel.weight / (channel.scale * channel.scale);
    equations.information += derivative.transpose() * weight.asDiagonal() * derivative;
    equations.gradient += derivative.transpose() * weight.cwiseProduct(channel.error);
  }
  const LimitParameters p = parameters_of(at.drive);
  for (Eigen::Index k = 0; k < equations.gradient.size(); ++k) {
    const PriorPull prior = prior_pull(free[static_cast<std::size_t>(k)], p, prior_, wheel_separation_);
    equations.information(k, k) += prior.precision;
    equations.gradient[k] -= prior.precision * prior.gap;
  }
  return equations;
}

ScoredActuator LimitedActuatorFit::refine(const LimitedActuator& drive, int steps, double wanted,
                                          double least_gain) const {
  const std::vector<int> free = free_parameters(drive);
  LimitParameters p = parameters_of(drive);
  GaussNewton search(p(free), {.iterations = steps * kAttempts, .absolute = least_gain, .longest_step = kLongestStep});
  FittedActuator best = fitted(drive);
  search.judge(best.loss.total);
  NormalEquations at_best = equations(best, free);
  for (search.propose(at_best); !search.over(); search.propose(at_best)) {
    p(free) = search.candidate();
    FittedActuator trial = fitted(with_parameters(best.drive, p));
    if (search.judge(trial.loss.total)) {
      const double gained = best.loss.total - trial.loss.total;
      best = std::move(trial);
      --steps;
      if (steps == 0 || best.loss.total - steps * gained > wanted) {
        break;
      }
      at_best = equations(best, free);
    }
  }
  return {best.drive, best.loss};
}

namespace {

/// Standard deviations from the covariance of free parameters, and from variances that are larger where need be.
LimitedActuatorFit::Spread spread_of(const std::vector<int>& free, const LimitParameters& p,
                                     const Eigen::MatrixXd& unlike, const Eigen::VectorXd& variance) {
  LimitedActuatorFit::Spread result{
      .std = {}, .lag_std = {}, .wheel_separation_std = 0.0, .to_sides = Eigen::Matrix3d::Zero()};
  constexpr std::array kToSides{0, 1, kSeparationPlace};
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const auto at = [&](Eigen::Index k) { return std::ranges::find(free, kToSides.at(static_cast<std::size_t>(k))); };
      if (at(i) != free.end() && at(j) != free.end()) {
        result.to_sides(i, j) = unlike(at(i) - free.begin(), at(j) - free.begin());
      }
    }
  }
  for (Eigen::Index k = 0; k < variance.size(); ++k) {
    const int parameter = free[static_cast<std::size_t>(k)];
    const double std = std::sqrt(std::max(variance[k], 0.0)) * std::exp(p[parameter]);
    if (is_lag(parameter)) {
      result.lag_std.at(static_cast<std::size_t>(parameter - kFirstLag)) = std;
    } else if (parameter == kSeparationPlace) {
      result.wheel_separation_std = std;
    } else if (parameter >= kFirstLimit) {
      const auto place = static_cast<std::size_t>(parameter - kFirstLimit);
      result.std.at(place / kLimitsPerAxis).at(place % kLimitsPerAxis + 1) = std;
    }
  }
  return result;
}

}  // namespace

LimitedActuatorFit::Spread LimitedActuatorFit::spread(const LimitedActuator& drive) const {
  const std::vector<int> free = free_parameters(drive);
  const auto size = static_cast<Eigen::Index>(free.size());
  const FittedActuator r = fitted(drive);
  const LimitParameters p = parameters_of(drive);
  Eigen::MatrixXd bread = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    bread(k, k) = prior_pull(free[static_cast<std::size_t>(k)], p, prior_, wheel_separation_).precision + 1e-12;
  }
  Eigen::MatrixXd meat = bread;
  Eigen::MatrixXd alone = bread;  // the meat, if no residual knew of another
  const Slopes all = derivatives(r, free);
  for (std::size_t c = 0; c < all.size(); ++c) {
    const FittedChannel& channel = r.channels.at(c);
    const Eigen::ArrayXd u = channel.error.array() / channel.scale;
    const Eigen::ArrayXd score = channel.weight.array() * u / channel.scale;
    const double curvature =
        ((kDof + 1.0) * (kDof - u.square()) / (kDof + u.square()).square()).mean() / (channel.scale * channel.scale);
    const Eigen::MatrixXd& mine = all.at(c);
    bread += std::max(curvature, 0.0) * mine.transpose() * mine;
    alone += score.square().mean() * mine.transpose() * mine;
    Eigen::Index row = 0;
    for (const WheelRecord& record : records_) {
      const auto end = row + static_cast<Eigen::Index>(record.t.size()) - 1;
      Eigen::VectorXd block = Eigen::VectorXd::Zero(size);
      double block_end = record.t.front() + kSecondsAlike;
      for (std::size_t i = 1; row < end; ++row, ++i) {
        if (later(record.t[i], block_end)) {
          meat += block * block.transpose();
          block.setZero();
          block_end = record.t[i] + kSecondsAlike;
        }
        block += score[row] * mine.row(row).transpose();
      }
      meat += block * block.transpose();
    }
  }
  const Eigen::MatrixXd inverse = solve_symmetric_columns(bread, Eigen::MatrixXd::Identity(size, size));
  // A limit may show in a few stretches alone, which the fit then follows: their residuals are too small to tell.
  const Eigen::MatrixXd unlike = inverse * alone * inverse;
  const Eigen::VectorXd variance = (inverse * meat * inverse).diagonal().cwiseMax(unlike.diagonal());
  return spread_of(free, p, unlike, variance);
}

}  // namespace slipwise
