// SPDX-License-Identifier: Apache-2.0
// What cleans poses and cuts segments goes on as it was, once it was saved and loaded.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/archive/reader.hpp"
#include "slipwise/archive/writer.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/sample_gate.hpp"
#include "slipwise/online/segment_cutter.hpp"

namespace slipwise {
namespace {

/// From a row of inputs and poses to segments.
struct Cutting {
  InputBuffer inputs{0.5};
  StampGate stamps;
  SpeedGate speeds;
  PoseGate gate;
  PoseTimer timer;
  SegmentCutter cutter{1.0, SegmentRules{}, true};

  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.inputs, self.stamps, self.speeds, self.gate, self.timer, self.cutter);
  }
};

std::string saved(const Cutting& cutting) {
  archive::Writer writer;
  writer(cutting);
  return writer.bytes();
}

Cutting loaded(const std::string& bytes) {
  Cutting cutting;
  archive::Reader reader(bytes);
  reader(cutting);
  reader.finish();
  return cutting;
}

struct Row {
  InputSample input;
  MeasuredPose pose;
};

/// A circle with noise, an outlier every 37 poses, a jump that lasts every 150 and a gap now and then.
std::vector<Row> rows() {
  std::mt19937 random(3);  // NOLINT(bugprone-random-generator-seed): the same rows every time
  std::normal_distribution<double> noise(0.0, 0.005);
  std::vector<Row> all;
  double t = 0.0;
  for (int i = 0; i < 600; ++i) {
    t += i % 97 == 0 ? 0.7 : 0.05;
    const double yaw = 0.4 * t;
    const double away = (i % 37 == 0 ? 3.0 : 0.0) + 5.0 * (i / 150);
    const MeasuredPose pose{.t = t,
                            .x = 1.25 * std::sin(yaw) + noise(random) + away,
                            .y = 1.25 * (1.0 - std::cos(yaw)) + noise(random),
                            .yaw = std::remainder(yaw, 2.0 * 3.14159265358979)};
    all.push_back({{t, {.v = 0.5, .vy = 0.0, .omega = 0.4}}, pose});
  }
  return all;
}

/// The ends and faults of the segments that the row completes.
void push(Cutting& cutting, const Row& row, std::vector<double>& out) {
  const std::array<double, 1> numbers{row.input.twist.v};
  out.push_back(cutting.stamps.check(row.input.t, numbers) ? 1.0 : 0.0);
  out.push_back(cutting.speeds.plausible(row.input.twist.v) ? 1.0 : 0.0);
  cutting.inputs.push(row.input);
  const GatedPoses gated = cutting.gate.push(row.pose, cutting.inputs);
  out.push_back(static_cast<double>(gated.outliers.size() + 10 * gated.jumps.size()));
  for (const MeasuredPose& pose : gated.accepted) {
    const auto timed = cutting.timer.push(pose, SegmentRules{}.late_factor);
    if (!timed) {
      continue;
    }
    for (const SegmentCut& cut : cutting.cutter.push(*timed, cutting.inputs)) {
      const double reason = cut.rejected ? static_cast<double>(*cut.rejected) : -1.0;
      out.insert(out.end(), {cut.first.t, cut.second.x, cut.second.yaw, reason});
    }
  }
}

}  // namespace

TEST_CASE("cut segments are the same, saved and loaded at any row") {
  const std::vector<Row> all = rows();
  Cutting whole;
  std::vector<double> expected;
  for (const Row& row : all) {
    push(whole, row, expected);
  }
  REQUIRE(expected.size() > 3 * all.size() + 40);
  Cutting cutting;
  std::vector<double> found;
  for (const Row& row : all) {
    const std::string bytes = saved(cutting);
    cutting = loaded(bytes);
    CHECK(saved(cutting) == bytes);
    push(cutting, row, found);
  }
  CHECK(found == expected);
  CHECK(saved(cutting) == saved(whole));
}

TEST_CASE("inputs without their greatest speeds are refused") {
  archive::Writer writer;
  writer(0.5, std::vector<InputSample>(1), std::vector<BodyTwist>(), 0.0);
  InputBuffer inputs(0.5);
  archive::Reader reader(writer.bytes());
  CHECK_THROWS_AS(reader(inputs), std::invalid_argument);
}

}  // namespace slipwise
