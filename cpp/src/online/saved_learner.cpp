// SPDX-License-Identifier: Apache-2.0
// A learner as bytes, and back.
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

MotionLearner MotionLearner::load(std::string_view saved) {
  archive::CheckedReader<LoadedValues> reader(archive::opened(saved));
  MotionLearner learner{LearnerSettings{}};
  reader(learner);
  reader.finish();
  const MotionLearner made(learner.learner_.settings());
  learner.stream_.check_loaded(made.stream_);
  learner.learner_.check_loaded(made.learner_);
  learner.localizer_ = made.localizer_;
  return learner;
}

}  // namespace slipwise
