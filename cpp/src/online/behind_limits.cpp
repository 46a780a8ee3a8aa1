// SPDX-License-Identifier: Apache-2.0
// Two models predict the same segments, one of them behind limits.
#include "slipwise/online/behind_limits.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <numbers>

#include "slipwise/filter/predictive_score.hpp"
#include "slipwise/filter/weighting.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kFewSegments = 8;         // that are predicted to compare
constexpr double kBetter = std::numbers::ln10;  // log score from which limits are taken to predict better

}  // namespace

DrivenSegment behind(const DrivenSegment& segment, const CommandLimits& limits) {
  DrivenSegment limited = segment;
  limited.inputs = limited_inputs(segment.inputs, limits);
  return limited;
}

double gain_behind(std::span<const DrivenSegment> segments, const LimitContest& contest) {
  std::array scores{PredictiveScore(contest.noise), PredictiveScore(contest.noise)};
  const std::array known{&contest.without, &contest.with};
  double sum = 0.0;
  for (const DrivenSegment& segment : segments) {
    const DrivenSegment limited = behind(segment, contest.limits);
    const std::array given{&segment, &limited};
    std::vector<ScoredSegment> predicted;
    for (std::size_t i = 0; i < 2; ++i) {
      predicted.push_back(scores[i].score(known[i]->model, known[i]->estimate, given[i]->inputs, given[i]->segment));
    }
    const Eigen::VectorXd each = common_log_scores(Eigen::Vector2d(0.5, 0.5), predicted);
    sum += each[1] - each[0];
  }
  return sum;
}

bool pays(double score, std::span<const DrivenSegment> segments, const LimitContest& contest,
          const MotionPosterior& kept) {
  const bool clear = segments.size() >= kFewSegments && score > kBetter;
  const LimitContest with_kept{.without = kept, .with = contest.with, .limits = contest.limits, .noise = contest.noise};
  return clear && (kept.structure == Structure::Cascaded || gain_behind(segments, with_kept) > 0.0);
}

std::shared_ptr<MotionPosterior> behind_all(std::span<const DrivenSegment> segments, const LimitContest& contest) {
  if (gain_behind(segments, contest) <= 0.0) {
    return nullptr;
  }
  auto posterior = std::make_shared<MotionPosterior>(contest.with);
  posterior->structure = Structure::Limited;
  return posterior;
}

std::vector<DrivenSegment> segments_since(std::span<const DrivenSegment> segments, double t) {
  std::vector<DrivenSegment> found;
  std::ranges::copy_if(segments, std::back_inserter(found),
                       [&](const DrivenSegment& segment) { return !later(t, segment.segment.start); });
  return found;
}

}  // namespace slipwise
