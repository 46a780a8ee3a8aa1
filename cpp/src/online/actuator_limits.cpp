// SPDX-License-Identifier: Apache-2.0
// A search for limits, and the actuator model behind them.
#include "slipwise/online/actuator_limits.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/filter/predictive_score.hpp"
#include "slipwise/identify/actuator_filter.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/behind_limits.hpp"

namespace slipwise {
namespace {

constexpr double kSpacing = 0.05;        // [s] between the twists that are looked at
constexpr std::size_t kFewTwists = 400;  // 20 s of driving; with fewer, chance passes for limits

/// Commands and twists of a stretch while it grows.
class Stretch {
 public:
  explicit Stretch(const WheelSegment& first) { add(first); }

  double end() const { return end_; }
  void add(const WheelSegment& segment) {
    for (std::size_t i = 0; i < segment.commands.size(); ++i) {
      if (command_t_.empty() || segment.commands.time(i) > command_t_.back()) {
        command_t_.push_back(segment.commands.time(i));
        commands_.push_back(segment.commands.sample(i));
      }
    }
    for (std::size_t i = 0; i < segment.wheels.size(); ++i) {
      const double t = segment.wheels.time(i);
      const bool apart = t_.empty() || !later(t_.back() + kSpacing, t);
      if (apart && !later(segment.start, t) && !later(t, segment.end)) {
        t_.push_back(t);
        wheels_.push_back(segment.wheels.sample(i));
      }
    }
    end_ = segment.end;
  }
  std::optional<WheelRecord> record() && {
    if (t_.size() < 2 || command_t_.empty()) {
      return std::nullopt;
    }
    return WheelRecord{.commands = InputHistory(std::move(command_t_), std::move(commands_)),
                       .t = std::move(t_),
                       .wheels = std::move(wheels_)};
  }

 private:
  std::vector<double> command_t_;
  std::vector<BodyTwist> commands_;
  std::vector<double> t_;
  std::vector<BodyTwist> wheels_;
  double end_ = 0.0;
};

/// The actuator model that segments of wheel speeds lead to, behind limits or not.
Estimate learned_actuator(std::span<const WheelSegment> wheels, const CausalFilterSettings& filter,
                          const CommandLimits* limits) {
  ActuatorFilter learner(filter, wheels.size());
  for (const WheelSegment& segment : wheels) {
    const InputHistory commands = limits == nullptr ? segment.commands : limited_inputs(segment.commands, *limits);
    learner.learn(commands, segment.wheels, segment.start, segment.end);
  }
  learner.end_refit();
  return learner.estimate();
}

MotionPosterior with_actuator(const MotionPosterior& cascaded, const Estimate& actuator) {
  MotionPosterior posterior = cascaded;
  std::vector<Eigen::Index> places(static_cast<std::size_t>(actuator.mean.size()));
  std::iota(places.begin(), places.end(), cascaded.model.slip_size());
  posterior.estimate.mean(places) = actuator.mean;
  posterior.estimate.covariance(places, places) = actuator.covariance;
  posterior.variance_ratio(places) =
      actuator.covariance.diagonal().cwiseQuotient(cascaded.prior_std(places).cwiseAbs2());
  return posterior;
}

}  // namespace

std::vector<WheelRecord> drive_records(std::span<const WheelSegment> wheels) {
  std::vector<WheelRecord> records;
  std::optional<Stretch> stretch;
  const auto close = [&] {
    if (stretch) {
      if (auto record = std::move(*stretch).record()) {
        records.push_back(std::move(*record));
      }
    }
  };
  for (const WheelSegment& segment : wheels) {
    if (stretch && same_stamp(segment.start, stretch->end())) {
      stretch->add(segment);
      continue;
    }
    close();
    stretch.emplace(segment);
  }
  close();
  return records;
}

std::optional<LimitSearch> search_limits(std::span<const WheelSegment> driven, const PriorSettings& prior,
                                         double wheel_separation) {
  const std::vector<WheelRecord> records = drive_records(driven);
  const std::size_t twists =
      std::accumulate(records.begin(), records.end(), std::size_t{0},
                      [](std::size_t sum, const WheelRecord& record) { return sum + record.t.size(); });
  if (twists < kFewTwists) {
    return std::nullopt;
  }
  return find_limits(records, prior, wheel_separation, {});
}

std::optional<ActuatorLimits> find_actuator_limits(const LimitData& data) {
  auto search = search_limits(data.wheels, data.filter.prior, data.wheel_separation);
  if (!search) {
    return std::nullopt;
  }
  ActuatorLimits result{.search = std::move(*search), .posterior = nullptr, .score = 0.0};
  if (result.search.found.empty()) {
    return result;
  }
  const CommandLimits& limits = result.search.drive.limits;
  const std::size_t half = data.wheels.size() / 2;
  const auto later = segments_since(data.segments, data.wheels[half].end);
  const auto first = data.wheels.first(half);
  const auto without = with_actuator(data.cascaded, learned_actuator(first, data.filter, nullptr));
  const auto with = with_actuator(data.cascaded, learned_actuator(first, data.filter, &limits));
  const NoiseSettings& noise = data.filter.noise;
  const LimitContest halves{.without = without, .with = with, .limits = limits, .noise = noise};
  result.score = gain_behind(later, halves);
  if (!pays(result.score, later, halves, data.kept)) {
    return result;
  }
  const auto all = with_actuator(data.cascaded, learned_actuator(data.wheels, data.filter, &limits));
  const auto posterior =
      behind_all(data.segments, {.without = data.kept, .with = all, .limits = limits, .noise = noise});
  if (posterior == nullptr) {
    return result;
  }
  PredictiveScore score(noise);
  for (const DrivenSegment& segment : data.segments) {
    const DrivenSegment limited = behind(segment, limits);
    score.score(posterior->model, posterior->estimate, limited.inputs, limited.segment);
  }
  posterior->noise_scale = score.noise_scale();
  result.posterior = posterior;
  return result;
}

}  // namespace slipwise
