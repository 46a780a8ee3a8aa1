// SPDX-License-Identifier: Apache-2.0
// A learner as bytes, and back.
#include <algorithm>
#include <array>
#include <variant>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/reader.hpp"
#include "slipwise/archive/writer.hpp"
#include "slipwise/online/loaded_values.hpp"
#include "slipwise/online/motion_learner.hpp"

namespace slipwise {

std::string MotionLearner::save() const {
  archive::Writer writer;
  writer(*this);
  return archive::sealed(writer.bytes());
}

/// Against what a learner of the same settings begins with, and what a prediction looks up without asking.
void MotionLearner::check_loaded() const {
  const MotionLearner made(settings_);
  stream_.check_loaded(made.stream_);
  hypotheses_.check_loaded(made.hypotheses_);
  sources_.check_loaded(made.sources_);
  known_.check_loaded(made.known_);
  errors_.check_loaded(settings_.stream.horizons);
  const std::size_t horizons = settings_.stream.horizons.size();
  const std::size_t classes = kPoseFixes * std::max<std::size_t>(1, settings_.stream.sources.size());
  const auto are_known = [&](const std::array<std::size_t, 2>& each) { return each[0] < classes && each[1] < classes; };
  const auto is_target = [&](const StreamItem& item) {
    const auto* target = std::get_if<TargetSegment>(&item);
    const auto* source = std::get_if<SourceSegment>(&item);
    return (target == nullptr || (target->horizon < horizons && are_known(target->classes))) &&
           (source == nullptr || (source->source < settings_.stream.sources.size() && are_known(source->classes)));
  };
  if (!std::ranges::all_of(waiting_, is_target)) {
    archive::refuse("malformed: its parts contradict each other");
  }
}

MotionLearner MotionLearner::load(std::string_view saved) {
  archive::CheckedReader<LoadedValues> reader(archive::opened(saved));
  MotionLearner learner{LearnerSettings{}};
  reader(learner);
  reader.finish();
  learner.check_loaded();
  learner.localizer_ = Localizer(pose_filter_settings(learner.settings_));
  return learner;
}

}  // namespace slipwise
