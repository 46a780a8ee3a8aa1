// SPDX-License-Identifier: Apache-2.0
#include "slipwise/online/judged_targets.hpp"

#include <doctest/doctest.h>

#include <stdexcept>

#include "online/kinematic_baseline.hpp"

using slipwise::CommandLimits;
using slipwise::DrivenSegment;
using slipwise::InputHistory;
using slipwise::JudgedTargets;

namespace {

/// 1 s at so many m/s.
DrivenSegment driven(double speed) {
  return {.inputs = InputHistory({0.0}, {{.v = speed}}), .segment = {.start = 0.0, .end = 1.0}};
}

}  // namespace

TEST_CASE("the last targets of a horizon are predicted again, the oldest first, behind limits where there are some") {
  JudgedTargets targets(2);
  const auto count = static_cast<Eigen::Index>(JudgedTargets::kMost);
  for (Eigen::Index i = 0; i < count + 3; ++i) {
    targets.keep(1, driven(0.01 * static_cast<double>(i)));
  }
  const JudgedTargets copy = targets;
  const auto poses = copy.predicted_by(kinematic_baseline(), {}, 1);
  REQUIRE(poses.rows() == count);
  CHECK(poses(0, 0) == doctest::Approx(0.03));
  CHECK(poses(count - 1, 0) == doctest::Approx(0.01 * static_cast<double>(count + 2)));
  CommandLimits limits;
  limits.speed.saturation = 0.3;
  CHECK(copy.predicted_by(kinematic_baseline(), limits, 1).col(0).maxCoeff() == doctest::Approx(0.3));
  CHECK(copy.predicted_by(kinematic_baseline(), {}, 0).rows() == 0);
  CHECK_THROWS_AS(copy.predicted_by(kinematic_baseline(), {}, 2), std::out_of_range);
}

TEST_CASE("targets of other horizons are refused") {
  CHECK_NOTHROW(JudgedTargets(3).check_loaded(JudgedTargets(3)));
  CHECK_THROWS_AS(JudgedTargets(2).check_loaded(JudgedTargets(3)), std::invalid_argument);
}
