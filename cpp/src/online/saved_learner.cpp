// SPDX-License-Identifier: Apache-2.0
// A learner as bytes, and back.
#include <algorithm>
#include <variant>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/reader.hpp"
#include "slipwise/archive/writer.hpp"
#include "slipwise/online/motion_learner.hpp"

namespace slipwise {

std::string MotionLearner::save() const {
  archive::Writer writer;
  writer(*this);
  return archive::sealed(writer.bytes());
}

/// What a prediction looks up without asking.
void MotionLearner::check_loaded() const {
  const std::size_t horizons = settings_.stream.horizons.size();
  const auto complete = [](const Knowledge& known) { return known.motion && known.slip && known.disturbance; };
  const auto is_target = [&](const StreamItem& item) {
    const auto* target = std::get_if<TargetSegment>(&item);
    return target == nullptr || target->horizon < horizons;
  };
  if (known_.empty() || !std::ranges::all_of(known_, complete) || errors_.size() != horizons ||
      held_out_.size() != horizons || !std::ranges::all_of(waiting_, is_target)) {
    archive::refuse("malformed: its parts contradict each other");
  }
}

MotionLearner MotionLearner::load(std::string_view saved) {
  archive::Reader reader(archive::opened(saved));
  MotionLearner learner{LearnerSettings{}};
  reader(learner);
  reader.finish();
  learner.check_loaded();
  const PoseFilterSettings poses = pose_filter_settings(learner.settings_);
  learner.pose_filter_ = PoseFilter(poses);
  learner.monitor_ = MotionMonitor(poses.nominal, poses.late_factor);
  return learner;
}

}  // namespace slipwise
