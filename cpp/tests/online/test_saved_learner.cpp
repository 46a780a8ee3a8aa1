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

}  // namespace
}  // namespace slipwise
