// SPDX-License-Identifier: Apache-2.0
// A learner that is saved and loaded goes on as one that never was.
#include <doctest/doctest.h>

#include <random>
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

constexpr double kSeconds = 60.0;  // refits begin, go on beside pushes, and take effect

void push_both(const Recording& run, std::size_t i, MotionLearner& one, MotionLearner& other) {
  for (MotionLearner* learner : {&one, &other}) {
    learner->push_command(run.commands[i].t, run.commands[i].twist);
    learner->push_wheels(run.wheels[i].t, run.wheels[i].twist);
    if (i % 2 == 0) {
      learner->push_pose(run.poses[i / 2]);
    }
  }
}

MotionLearner taught(bool from_commands) {
  MotionLearner learner(learner_settings(from_commands));
  learner.start_run();
  push(learner, streamed_robot(3, 20.0));
  return learner;
}

TEST_CASE("saved and loaded at random places, a learner goes on to the same bytes and predictions") {
  for (const bool from_commands : {false, true}) {
    CAPTURE(from_commands);
    std::mt19937_64 random(7);
    MotionLearner silent(learner_settings(from_commands));
    MotionLearner moved = silent;
    for (const std::uint64_t seed : {1, 2}) {
      const Recording run = streamed_robot(seed, kSeconds);
      silent.start_run();
      moved.start_run();
      for (std::size_t i = 0; i < run.commands.size(); ++i) {
        push_both(run, i, silent, moved);
        if (random() % 64 == 0) {
          const std::string saved = moved.save();
          REQUIRE(saved == silent.save());
          moved = MotionLearner::load(saved);
          const std::vector<InputSample> ahead{{run.commands[i].t + 0.1, {0.5, 0.0, 0.2}}};
          const PredictedPath one = silent.predict(ahead, 2.0);
          const PredictedPath other = moved.predict(ahead, 2.0);
          CHECK(one.poses == other.poses);
          CHECK(one.covariances == other.covariances);
        }
      }
    }
    CHECK(moved.model().segments > 30);
    CHECK(moved.events().size() == silent.events().size());
    CHECK(moved.save() == silent.save());
  }
}

TEST_CASE("a copy of a learner has the same bytes") {
  const MotionLearner learner = taught(true);
  const MotionLearner copy = learner;
  CHECK(learner.save() == copy.save());
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

}  // namespace
}  // namespace slipwise
