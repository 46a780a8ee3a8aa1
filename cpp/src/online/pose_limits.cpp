// SPDX-License-Identifier: Apache-2.0
// A search for limits in twists between poses, and the joint model behind them.
#include "slipwise/online/pose_limits.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "slipwise/online/behind_limits.hpp"

namespace slipwise {
namespace {

/// What segments lead to.
std::shared_ptr<const MotionPosterior> learned(std::span<const DrivenSegment> segments,
                                               const HypothesisSettings& settings, const CommandLimits* limits) {
  MotionHypotheses hypotheses(settings);
  for (const DrivenSegment& segment : segments) {
    hypotheses.start(limits == nullptr ? segment : behind(segment, *limits), false);
    while (hypotheses.advance()) {
    }
  }
  return hypotheses.structures().posterior();
}

/// Limits act on an actuator, whose lag and delay are learned behind them.
HypothesisSettings joint_alone(HypothesisSettings settings) {
  settings.cascaded = settings.direct = settings.baseline = false;
  return settings;
}

/// Twists between poses slip: a gain below 1 is the terrain's, and stands behind the sides. The search has all gain in
/// front of them, which is the same to another wheel_separation and other limits: g_v s = g_v v + g_omega omega w' / 2
/// asks s = v + omega w / 2 of a side, where w = w' g_omega / g_v.
LimitSearch with_gain_behind_sides(LimitSearch search) {
  auto& [limits, actuator, behind, edge] = search.drive;
  if (!limits_sides(limits)) {
    return search;
  }
  actuator.gain_v = std::min(limits.gain_v, 1.0);
  actuator.gain_omega = std::min(limits.gain_omega, 1.0);
  limits.gain_v /= actuator.gain_v;
  limits.gain_omega /= actuator.gain_omega;
  limits.wheel_separation *= actuator.gain_omega / actuator.gain_v;
  search.wheel_separation_std *= actuator.gain_omega / actuator.gain_v;
  for (const LimitKind kind : kLimitKinds) {
    limit_of(limits.side, kind) /= actuator.gain_v;
  }
  for (FoundLimit& found : search.found) {
    if (found.axis == LimitedAxis::Side && found.kind != LimitKind::SlewRateLag) {
      found.value /= actuator.gain_v;
      found.std /= actuator.gain_v;
    }
  }
  return search;
}

}  // namespace

std::optional<ActuatorLimits> find_pose_limits(const PoseLimitData& data) {
  auto search = search_limits(data.twists, data.settings.filter.prior, data.wheel_separation);
  if (!search || data.segments.empty()) {
    return std::nullopt;
  }
  ActuatorLimits result{.search = with_gain_behind_sides(std::move(*search)), .posterior = nullptr, .score = 0.0};
  if (result.search.found.empty()) {
    return result;
  }
  const CommandLimits& limits = result.search.drive.limits;
  const NoiseSettings& noise = data.settings.filter.noise;
  const auto first = data.segments.first(data.segments.size() / 2);
  const auto later = data.segments.subspan(first.size());
  const HypothesisSettings joint = joint_alone(data.settings);
  const auto without = learned(first, data.settings, nullptr);
  const auto with = learned(first, joint, &limits);
  const LimitContest halves{.without = *without, .with = *with, .limits = limits, .noise = noise};
  result.score = gain_behind(later, halves);
  if (pays(result.score, later, halves, data.kept)) {
    const auto all = learned(data.segments, joint, &limits);
    result.posterior =
        behind_all(data.segments, {.without = data.kept, .with = *all, .limits = limits, .noise = noise});
  }
  return result;
}

}  // namespace slipwise
