// SPDX-License-Identifier: Apache-2.0
// Columns of what is not known, their covariance's factor, and what they change of the program.
#include "slipwise/rollout/tangent_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace slipwise {
namespace {

constexpr double kOffBoundary = 1e-6;  // of a piece of the period
constexpr double kNoPivot = 1e-12;     // of a variance: what is left of it is rounding

constexpr std::array kDelays{kDelayV, kDelayOmega};

/// Moves what makes commands act, as far as it is not known, so that they neither act at a period's boundary nor both
/// at once: where two parts meet, one of them has no length and no derivative.
Eigen::VectorXd off_boundaries(const UncertainModel& model) {
  const double piece = RolloutProgram(model.model, model.parameters, model.setting).actuator().period;
  Eigen::VectorXd parameters = model.parameters;
  const auto& places = model.model.actuator_places();
  const double little = kOffBoundary * piece;
  const auto near = [&](double seconds) {
    return std::abs(seconds - std::round(seconds / piece) * piece) < 0.5 * little;
  };
  const auto moved = [&](Eigen::Index place) {
    const auto found = std::ranges::find(places, place) - places.begin();
    const Eigen::Index at = model.model.slip_size() + found;
    if (found == std::ssize(places)) {
      return false;
    }
    const double rate = model.model.actuator_scales(model.model.actuator(parameters))[found];
    if (!(rate * std::sqrt(model.uncertainty.covariance(at, at)) > little)) {
      return false;
    }
    parameters[at] += rate == 1.0 ? little : std::log1p(little / rate);
    return true;
  };
  const auto delays = [&] {
    const ActuatorModel now = model.model.actuator(parameters);
    return std::array{now.delay_v + now.clock_offset, now.delay_omega + now.clock_offset};
  };
  if (near(delays()[0])) {
    moved(kDelays[0]) || moved(kClockOffset);
  }
  for (int i = 0; i < 2 && (near(delays()[1]) || near(delays()[0] - delays()[1])); ++i) {
    if (!moved(kDelays[1])) {
      break;
    }
  }
  return parameters;
}

/// F of a covariance F F^T, lower triangular; what is known for certain has a column of zeros.
Eigen::MatrixXd triangular_root(Eigen::MatrixXd covariance) {
  const Eigen::Index size = covariance.rows();
  const Eigen::VectorXd variances = covariance.diagonal();
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    const double left = covariance(j, j);
    if (left > kNoPivot * variances[j]) {
      const Eigen::Index below = size - j;
      root.col(j).tail(below) = covariance.col(j).tail(below) / std::sqrt(left);
      covariance.bottomRightCorner(below, below) -= root.col(j).tail(below) * root.col(j).tail(below).transpose();
    }
  }
  return root;
}

template <typename T>
std::vector<PeriodPartOf<T>> all_parts(const ActuatorScheduleOf<T>& actuator) {
  std::vector<PeriodPartOf<T>> parts = actuator.lead_in;
  parts.insert(parts.end(), actuator.cycle.begin(), actuator.cycle.end());
  parts.insert(parts.end(), actuator.tail.begin(), actuator.tail.end());
  return parts;
}

/// Whether a channel answers otherwise when a parameter of the actuator changes.
bool hangs_on(const ChannelTimingOf<ActuatorDual>& channel, int place) {
  const auto& [gain, fast, fraction, slow] = channel.response;
  return std::ranges::any_of(std::array{&channel.rest, &gain, &fast, &fraction, &slow},
                             [&](const ActuatorDual* number) { return number->by[place] != 0.0; });
}

template <typename Scalar>
LaneLag<Scalar> derivative_of(const LaneLag<ActuatorDual>& lag, int place) {
  const auto by = [place](const ActuatorDual& number) { return static_cast<Scalar>(number.by[place]); };
  return {by(lag.mean_by_input), by(lag.mean_by_fast),  by(lag.mean_by_slow), by(lag.fast_by_input),
          by(lag.fast_by_fast),  by(lag.slow_by_input), by(lag.slow_by_slow)};
}

}  // namespace

template <typename Scalar>
TangentPlan<Scalar>::TangentPlan(const UncertainModel& model, std::size_t periods, std::span<const double> growth)
    : program_(model.model, off_boundaries(model), model.setting),
      actuator_(
          schedule_actuator(differentiable_numbers(model.model, off_boundaries(model)), program_.actuator().period)),
      noise_(model.uncertainty.noise),
      root_(model.uncertainty.scale.cwiseSqrt()) {
  add_actuator(model);
  add_slip(model);
  add_disturbance(model, periods);
  for (std::size_t k = 0; k < periods; ++k) {
    inflation_.push_back(static_cast<Scalar>(model.uncertainty.inflation * (growth.empty() ? 1.0 : growth[k])));
  }
}

template <typename Scalar>
void TangentPlan<Scalar>::add_actuator(const UncertainModel& model) {
  for (Eigen::Index i = 0; i < model.model.actuator_size(); ++i) {
    const Eigen::Index at = model.model.slip_size() + i;
    if (model.uncertainty.covariance(at, at) > 0.0) {
      actuator_places_.push_back(static_cast<int>(i));
    }
  }
  const std::vector<PeriodPartOf<ActuatorDual>> parts = all_parts(actuator_);
  for (const int place : actuator_places_) {
    const bool cuts = std::ranges::any_of(parts, [&](const auto& part) { return part.duration.by[place] != 0.0; });
    moved_.push_back((cuts || hangs_on(actuator_.v, place) ? 1U : 0U) |
                     (cuts || hangs_on(actuator_.omega, place) ? 2U : 0U));
  }
  for (const PeriodPartOf<ActuatorDual>& part : parts) {
    const auto v = lane_lag(part.v, actuator_.v.response), omega = lane_lag(part.omega, actuator_.omega.response);
    for (const int place : actuator_places_) {
      parts_.push_back({static_cast<Scalar>(part.duration.by[place]), derivative_of<Scalar>(v, place),
                        derivative_of<Scalar>(omega, place)});
    }
  }
}

/// Columns that may turn the robot come first.
template <typename Scalar>
void TangentPlan<Scalar>::add_slip(const UncertainModel& model) {
  const MotionModel& motion = model.model;
  const Eigen::MatrixXd& learned = model.uncertainty.covariance;
  const DisturbedTerms terms = disturbed_terms_of(model);
  for (Eigen::Index i = 0; i < motion.slip_size(); ++i) {
    if (learned(i, i) > 0.0 || std::ranges::find(terms.places, i) != terms.places.end()) {
      add_column(motion, i, Eigen::VectorXd::Unit(motion.slip_size(), i));
    }
  }
  for (const Eigen::MatrixXd& direction : model.uncertainty.ahead) {
    add_column(motion, kAhead, direction);
  }
  const auto others = std::ranges::stable_partition(columns_, &Column::turns);
  turning_ = actuator_places_.size() + static_cast<std::size_t>(others.begin() - columns_.begin());
  std::vector<Eigen::Index> parameters;
  for (const int place : actuator_places_) {
    parameters.push_back(motion.slip_size() + place);
    first_entry_.push_back(0);
  }
  for (const Column& column : columns_) {
    parameters.push_back(column.parameter);
    first_entry_.push_back(entries_.size());
    entries_.insert(entries_.end(), column.entries.begin(), column.entries.end());
  }
  first_entry_.push_back(entries_.size());
  const Eigen::Index size = std::ssize(parameters);
  add_factor(Eigen::MatrixXd::NullaryExpr(size, size, [&](Eigen::Index i, Eigen::Index j) {
    const Eigen::Index a = parameters[static_cast<std::size_t>(i)], b = parameters[static_cast<std::size_t>(j)];
    return a == kAhead || b == kAhead ? (i == j ? 1.0 : 0.0) : learned(a, b);
  }));
}

/// A direction [slip, stretches] of the slip; one stretch stands for all.
template <typename Scalar>
void TangentPlan<Scalar>::add_column(const MotionModel& model, Eigen::Index parameter,
                                     const Eigen::MatrixXd& by_stretch) {
  const RolloutSetting& setting = program_.setting();
  Column column{.parameter = parameter, .entries = {}, .turns = setting.on_grade() || !setting.ahead.empty()};
  for (Eigen::Index k = 0; k < by_stretch.cols(); ++k) {
    Eigen::VectorXd change = by_stretch.col(k);
    if (k > 0) {
      change -= by_stretch.col(k - 1);
    }
    const SlipProgram program = slip_change(model, change, setting);
    for (std::size_t product = 0; product < program.products.size(); ++product) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        if (const double rate = program.products[product].fraction[channel]; rate != 0.0) {
          column.entries.push_back({static_cast<std::uint8_t>(product), static_cast<std::uint8_t>(channel),
                                    static_cast<std::uint8_t>(k), static_cast<Scalar>(rate)});
          column.turns = column.turns || channel == 2;
        }
      }
    }
  }
  columns_.push_back(std::move(column));
}

template <typename Scalar>
void TangentPlan<Scalar>::add_factor(const Eigen::MatrixXd& covariance) {
  const Eigen::MatrixXd root = triangular_root(covariance);
  constexpr auto kTogether = static_cast<Eigen::Index>(kColumnsTogether);
  for (Eigen::Index first = 0; first < root.cols(); first += kTogether) {
    for (Eigen::Index row = first; row < root.rows(); ++row) {
      for (Eigen::Index column = first; column < first + kTogether; ++column) {
        factor_.push_back(static_cast<Scalar>(column < root.cols() ? root(row, column) : 0.0));
      }
    }
  }
}

/// The slip disturbance acts on the pose after some time as its mean over that time does.
template <typename Scalar>
void TangentPlan<Scalar>::add_disturbance(const UncertainModel& model, std::size_t periods) {
  const DisturbedTerms terms = disturbed_terms_of(model);
  for (const Eigen::Index place : terms.places) {
    const auto found = std::ranges::find(columns_, place, &Column::parameter) - columns_.begin();
    disturbed_.push_back(actuator_places_.size() + static_cast<std::size_t>(found));
  }
  for (std::size_t k = 1; k <= periods && terms.size() > 0; ++k) {
    const double seconds = static_cast<double>(k) * model.setting.period;
    const Eigen::VectorXd variances = nominal_variances(model.uncertainty.disturbance, terms, seconds);
    std::ranges::transform(variances, std::back_inserter(disturbance_),
                           [](double variance) { return static_cast<Scalar>(variance); });
  }
}

template <typename Scalar>
LaneTangents<Scalar> TangentPlan<Scalar>::lanes() const {
  return {.columns = actuator_places_.size() + columns_.size(),
          .actuator = actuator_places_.size(),
          .turning = turning_,
          .first_entry = first_entry_.data(),
          .entries = entries_.data(),
          .parts = parts_.data(),
          .start = nullptr,
          .moved = moved_.data(),
          .factor = factor_.data(),
          .disturbed_count = disturbed_.size(),
          .disturbed = disturbed_.data(),
          .disturbance = disturbance_.data(),
          .noise = lane_noise<Scalar>(noise_),
          .root = {static_cast<Scalar>(root_[0]), static_cast<Scalar>(root_[1]), static_cast<Scalar>(root_[2])},
          .inflation = inflation_.data(),
          .state = nullptr,
          .out = nullptr};
}

template class TangentPlan<float>;
template class TangentPlan<double>;

}  // namespace slipwise
