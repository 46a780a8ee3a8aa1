// SPDX-License-Identifier: Apache-2.0
#include "slipwise/online/behind_limits.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "online/kinematic_baseline.hpp"
#include "slipwise/segment/integrate_segment.hpp"

using slipwise::CommandLimits;
using slipwise::DrivenSegment;
using slipwise::InputHistory;
using slipwise::MotionPosterior;
using slipwise::NoiseSettings;
using slipwise::Structure;

namespace {

constexpr double kTop = 0.6;  // [m/s]

CommandLimits limited() {
  CommandLimits limits;
  limits.speed.saturation = kTop;
  return limits;
}

/// Segments of 2 s driven at a command of 1 m/s, of which 0.6 m/s come through.
std::vector<DrivenSegment> segments(int count) {
  std::vector<DrivenSegment> all;
  for (int i = 0; i < count; ++i) {
    const double start = 2.0 * i;
    DrivenSegment driven{.inputs = InputHistory({start}, {{.v = 1.0}}),
                         .segment = {.start = start, .end = start + 2.0}};
    driven.segment.measured.front().z[0] = 2.0 * kTop;
    all.push_back(driven);
  }
  return all;
}

}  // namespace

TEST_CASE("behind a limit a segment is driven by what comes through") {
  const DrivenSegment driven = behind(segments(1).front(), limited());
  CHECK(driven.inputs.at(1.0).v == doctest::Approx(kTop));
  CHECK(rows_of(driven.segment.measured)[0] == doctest::Approx(2.0 * kTop));
}

TEST_CASE("limits that act gain, and limits that do not lose nothing") {
  const MotionPosterior same = kinematic_baseline();
  const NoiseSettings noise;
  const CommandLimits free;
  const CommandLimits limits = limited();
  const auto all = segments(12);
  CHECK(gain_behind(all, {.without = same, .with = same, .limits = limits, .noise = noise}) > 3.0);
  CHECK(gain_behind(all, {.without = same, .with = same, .limits = free, .noise = noise}) == doctest::Approx(0.0));
}

TEST_CASE("limits pay by a clear gain over many segments, and against what is kept by any, unless it is cascaded") {
  MotionPosterior kept = kinematic_baseline();
  const NoiseSettings noise;
  const CommandLimits free;
  const CommandLimits limits = limited();
  const auto all = segments(12);
  const auto pay = [&](double score, const std::vector<DrivenSegment>& given, const CommandLimits& behind) {
    return pays(score, given, {.without = kept, .with = kept, .limits = behind, .noise = noise}, kept);
  };
  CHECK(pay(3.0, all, limits));
  CHECK_FALSE(pay(2.0, all, limits));
  CHECK_FALSE(pay(3.0, segments(7), limits));
  CHECK_FALSE(pay(3.0, all, free));
  kept.structure = Structure::Cascaded;
  CHECK(pay(3.0, all, free));
}

TEST_CASE("the estimate behind limits of all segments is handed on where it predicts them better than what is kept") {
  const MotionPosterior same = kinematic_baseline();
  const NoiseSettings noise;
  const CommandLimits limits = limited();
  const auto posterior = behind_all(segments(12), {.without = same, .with = same, .limits = limits, .noise = noise});
  REQUIRE(posterior != nullptr);
  CHECK(posterior->structure == Structure::Limited);
  const CommandLimits free;
  CHECK(behind_all(segments(12), {.without = same, .with = same, .limits = free, .noise = noise}) == nullptr);
}

TEST_CASE("segments since a moment start there or later") {
  const auto later = slipwise::segments_since(segments(5), 4.0);
  REQUIRE(later.size() == 3);
  CHECK(later.front().segment.start == 4.0);
}
