// SPDX-License-Identifier: Apache-2.0
// Limits in wheel speeds, or in twists between poses where there are none.
#include "slipwise/online/limit_evidence.hpp"

#include <utility>
#include <vector>

#include "slipwise/online/pose_limits.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kMostWheelSegments = 200;
constexpr std::size_t kMostCommandSegments = 100;

template <class Segment>
void keep_last(std::deque<Segment>& kept, Segment segment, std::size_t most) {
  kept.push_back(std::move(segment));
  if (kept.size() > most) {
    kept.pop_front();
  }
}

}  // namespace

void LimitEvidence::keep_wheels(WheelSegment segment) { keep_last(wheels_, std::move(segment), kMostWheelSegments); }

void LimitEvidence::keep_twists(WheelSegment segment) { keep_last(twists_, std::move(segment), kMostWheelSegments); }

void LimitEvidence::keep(const DrivenSegment& segment) { keep_last(commands_, segment, kMostCommandSegments); }

std::optional<ActuatorLimits> LimitEvidence::find(const Structures& learned, const MotionPosterior& kept,
                                                  const HypothesisSettings& settings, double wheel_separation) const {
  const auto cascaded = learned.of(Structure::Cascaded);
  const std::vector<DrivenSegment> segments(commands_.begin(), commands_.end());
  if (cascaded == nullptr) {
    const std::vector<WheelSegment> twists(twists_.begin(), twists_.end());
    return find_pose_limits({.twists = twists,
                             .segments = segments,
                             .kept = kept,
                             .settings = settings,
                             .wheel_separation = wheel_separation});
  }
  const std::vector<WheelSegment> wheels(wheels_.begin(), wheels_.end());
  return find_actuator_limits({.wheels = wheels,
                               .segments = segments,
                               .cascaded = *cascaded,
                               .kept = kept,
                               .filter = settings.filter,
                               .wheel_separation = wheel_separation});
}

}  // namespace slipwise
