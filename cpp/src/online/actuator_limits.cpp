// SPDX-License-Identifier: Apache-2.0
// A search for limits, and the actuator model behind them.
#include "slipwise/online/actuator_limits.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/estimate/chain_learner.hpp"
#include "slipwise/estimate/predictive_score.hpp"
#include "slipwise/estimate/weighing.hpp"

namespace slipwise {
namespace {

constexpr double kSpacing = 0.05;               // [s] between the twists that are looked at
constexpr double kRounding = 1e-6;              // [s] of stamps
constexpr std::size_t kFewTwists = 400;         // 20 s of driving; with fewer, chance passes for limits
constexpr std::size_t kFewSegments = 8;         // that are predicted to compare
constexpr double kBetter = std::numbers::ln10;  // log score from which limits are believed to predict better

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
      const bool later = t_.empty() || t >= t_.back() + kSpacing - kRounding;
      if (later && t >= segment.start - kRounding && t <= segment.end) {
        t_.push_back(t);
        wheels_.push_back(segment.wheels.sample(i));
      }
    }
    end_ = segment.end;
  }
  std::optional<DriveRecord> record() && {
    if (t_.size() < 2 || command_t_.empty()) {
      return std::nullopt;
    }
    return DriveRecord{.commands = InputTrack(std::move(command_t_), std::move(commands_)),
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
  ChainLearner learner(filter, wheels.size());
  for (const WheelSegment& segment : wheels) {
    const InputTrack commands = limits == nullptr ? segment.commands : limited_track(segment.commands, *limits);
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

DrivenSegment behind(const DrivenSegment& segment, const CommandLimits& limits) {
  DrivenSegment limited = segment;
  limited.inputs = limited_track(segment.inputs, limits);
  return limited;
}

/// Log score of the segments behind the limits over that without limits, each by what it knew before them.
double compare(std::span<const DrivenSegment> segments, const std::array<MotionPosterior, 2>& known,
               const CommandLimits& limits, const NoiseSettings& noise) {
  std::array scores{PredictiveScore(noise), PredictiveScore(noise)};
  double sum = 0.0;
  for (const DrivenSegment& segment : segments) {
    const DrivenSegment limited = behind(segment, limits);
    const std::array given{&segment, &limited};
    std::array<Eigen::Vector3d, 2> innovations;
    std::array<Eigen::Matrix3d, 2> covariances;
    for (std::size_t i = 0; i < 2; ++i) {
      const ScoredSegment scored =
          scores[i].score(known[i].model, known[i].estimate, given[i]->inputs, given[i]->segment);
      innovations[i] = scored.innovation;
      covariances[i] = scored.innovation_covariance;
    }
    const Eigen::VectorXd each = common_log_scores(Eigen::Vector2d(0.5, 0.5), innovations, covariances);
    sum += each[1] - each[0];
  }
  return sum;
}

}  // namespace

std::vector<DriveRecord> drive_records(std::span<const WheelSegment> wheels) {
  std::vector<DriveRecord> records;
  std::optional<Stretch> stretch;
  const auto close = [&] {
    if (stretch) {
      if (auto record = std::move(*stretch).record()) {
        records.push_back(std::move(*record));
      }
    }
  };
  for (const WheelSegment& segment : wheels) {
    if (stretch && std::abs(segment.start - stretch->end()) < kRounding) {
      stretch->add(segment);
      continue;
    }
    close();
    stretch.emplace(segment);
  }
  close();
  return records;
}

std::optional<ActuatorLimits> find_actuator_limits(const LimitData& data) {
  const std::vector<DriveRecord> records = drive_records(data.wheels);
  const std::size_t twists =
      std::accumulate(records.begin(), records.end(), std::size_t{0},
                      [](std::size_t sum, const DriveRecord& record) { return sum + record.t.size(); });
  if (twists < kFewTwists) {
    return std::nullopt;
  }
  ActuatorLimits result{
      .search = find_limits(records, data.filter.prior, data.wheel_separation, {}), .posterior = nullptr, .score = 0.0};
  if (result.search.found.empty()) {
    return result;
  }
  const CommandLimits& limits = result.search.drive.limits;
  const std::size_t half = data.wheels.size() / 2;
  const double until = data.wheels[half].end;
  std::vector<DrivenSegment> later;
  for (const DrivenSegment& segment : data.segments) {
    if (segment.segment.start >= until) {
      later.push_back(segment);
    }
  }
  const auto first = data.wheels.first(half);
  const std::array known{with_actuator(data.cascaded, learned_actuator(first, data.filter, nullptr)),
                         with_actuator(data.cascaded, learned_actuator(first, data.filter, &limits))};
  result.score = compare(later, known, limits, data.filter.noise);
  const bool better = later.size() >= kFewSegments && result.score > kBetter;
  // Another structure has learned these segments, which is hard to beat: it need not be beaten clearly.
  const bool best = data.kept.structure == Structure::Cascaded ||
                    (better && compare(later, {data.kept, known[1]}, limits, data.filter.noise) > 0.0);
  if (!better || !best) {
    return result;
  }
  MotionPosterior posterior = with_actuator(data.cascaded, learned_actuator(data.wheels, data.filter, &limits));
  posterior.structure = Structure::CascadedWithLimits;
  PredictiveScore score(data.filter.noise);
  for (const DrivenSegment& segment : data.segments) {
    const DrivenSegment limited = behind(segment, limits);
    score.score(posterior.model, posterior.estimate, limited.inputs, limited.segment);
  }
  posterior.noise_scale = score.noise_scale();
  result.posterior = std::make_shared<const MotionPosterior>(std::move(posterior));
  return result;
}

}  // namespace slipwise
