// SPDX-License-Identifier: Apache-2.0
// Measurements as they come become segments that touch, predictions to judge, and counted rejections.
#include <doctest/doctest.h>

#include <variant>
#include <vector>

#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

SegmentStream straight_drive() {
  StreamSettings settings;
  settings.from_commands = false;
  settings.segment_length = 1.0;
  settings.horizons = {1.0, 2.0};
  SegmentStream stream(settings);
  stream.start_run();
  for (int i = 0; i < 200; ++i) {
    const double t = 0.05 * i;
    stream.push(WheelSample{{t, {1.0, 0.0, 0.0}}});
    if (i % 2 == 0) {
      stream.push(MeasuredPose{.t = t, .x = t, .y = 0.0, .yaw = 0.0});
    }
  }
  return stream;
}

TEST_CASE("a drive becomes segments that touch, and a prediction to judge of every horizon") {
  SegmentStream stream = straight_drive();
  stream.end_run();
  double end = 0.0;
  std::vector<int> targets(2);
  for (const StreamItem& item : stream.take_items()) {
    if (const auto* learned = std::get_if<DrivenSegment>(&item)) {
      CHECK(learned->segment.start == doctest::Approx(end));
      CHECK(learned->segment.end - learned->segment.start == doctest::Approx(1.0));
      CHECK(learned->known_at >= learned->segment.end);
      end = learned->segment.end;
    } else if (const auto* target = std::get_if<TargetSegment>(&item)) {
      const Segment& over = target->driven.segment;
      CHECK(over.end - over.start == doctest::Approx(stream.settings().horizons[target->horizon]).epsilon(0.1));
      ++targets[target->horizon];
    }
  }
  CHECK(end == doctest::Approx(9.0));
  CHECK(targets[0] >= 8);
  CHECK(targets[1] >= 4);
  CHECK(stream.take_items().empty());
}

TEST_CASE("what cannot be used is rejected with its stream and reason, once") {
  SegmentStream stream = straight_drive();
  stream.push(WheelSample{{9.95, {2.0, 0.0, 0.0}}});
  stream.push(MeasuredPose{.t = 2.0, .x = 0.0, .y = 0.0, .yaw = 0.0});
  const auto rejected = stream.take_rejected();
  REQUIRE(rejected.size() == 2);
  CHECK(rejected[0].stream == Stream::Wheels);
  CHECK(rejected[0].reason == Reason::DuplicateStamp);
  CHECK(rejected[1].stream == Stream::Pose);
  CHECK(rejected[1].t == 2.0);
  CHECK(stream.take_rejected().empty());
}

TEST_CASE("commands to come continue the pose now") {
  const SegmentStream stream = straight_drive();
  const DrivenSegment ahead =
      stream.drive().ahead(stream.over(stream.newest(), stream.newest() + 2.0), {{9.95, {0.5, 0.0, 0.0}}});
  CHECK(ahead.segment.end - ahead.segment.start == doctest::Approx(2.0));
  CHECK(ahead.segment.start <= stream.newest());
}

}  // namespace
}  // namespace slipwise
