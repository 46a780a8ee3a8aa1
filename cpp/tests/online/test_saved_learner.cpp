// SPDX-License-Identifier: Apache-2.0
// What is no saved learner is refused.
#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/writer.hpp"
#include "slipwise/online/motion_learner.hpp"
#include "streamed_robot.hpp"

namespace slipwise {
namespace {

using tests::learner_settings;
using tests::streamed_robot;

MotionLearner taught(bool from_commands) {
  MotionLearner learner(learner_settings(from_commands));
  learner.start_run();
  push(learner, streamed_robot(3, 20.0));
  return learner;
}

TEST_CASE("what is truncated or altered is refused") {
  const std::string saved = taught(false).save();
  for (std::size_t size = 0; size < saved.size(); size += saved.size() / 97) {
    CHECK_THROWS_AS(MotionLearner::load(std::string_view(saved).substr(0, size)), std::invalid_argument);
  }
  for (std::size_t place = 0; place < saved.size(); place += saved.size() / 97) {
    std::string altered = saved;
    altered[place] = static_cast<char>(static_cast<unsigned char>(altered[place]) ^ 1U);
    CHECK_THROWS_AS(MotionLearner::load(altered), std::invalid_argument);
  }
}

TEST_CASE("what is sealed but no learner is refused, however it ends") {
  archive::Writer writer;
  writer(taught(true));
  const std::string& body = writer.bytes();
  for (std::size_t size = 0; size < body.size(); size += body.size() / 211) {
    const std::string sealed = archive::sealed(std::string_view(body).substr(0, size));
    CHECK_THROWS_AS(MotionLearner::load(sealed), std::invalid_argument);
  }
  CHECK_THROWS_AS(MotionLearner::load(archive::sealed(body + "x")), std::invalid_argument);
  CHECK_NOTHROW(MotionLearner::load(archive::sealed(body)));
}

TEST_CASE("branches go on from where they were saved, to the byte") {
  for (const bool from_commands : {false, true}) {
    CAPTURE(from_commands);
    const LearnerSettings settings = learner_settings(from_commands);
    const Recording run = streamed_robot(8, 60.0);
    MotionLearner whole(settings);
    whole.start_run();
    push(whole, run);
    Recording first;
    Recording second;
    const double half = run.poses[run.poses.size() / 2].t;
    const auto split = [half](const auto& all, auto& before, auto& after) {
      for (const auto& each : all) {
        (each.t < half ? before : after).push_back(each);
      }
    };
    split(run.commands, first.commands, second.commands);
    split(run.wheels, first.wheels, second.wheels);
    split(run.poses, first.poses, second.poses);
    MotionLearner begun(settings);
    begun.start_run();
    push(begun, first);
    MotionLearner loaded = MotionLearner::load(begun.save());
    CHECK(loaded.save() == begun.save());
    push(loaded, second);
    CHECK(loaded.save() == whole.save());
  }
}

}  // namespace
}  // namespace slipwise
