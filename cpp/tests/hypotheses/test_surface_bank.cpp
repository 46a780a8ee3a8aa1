// SPDX-License-Identifier: Apache-2.0
// The surfaces that are kept, what they are called, and which of them compete at a start.
#include "slipwise/hypotheses/surface_bank.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "hypotheses/surfaces_learned.hpp"

namespace slipwise {
namespace {

using tests::kWhiteSlip;

/// Surfaces of these yaw slips, each driven for 40 segments, and an average that has driven.
struct Known {
  RememberingAverage average = tests::remembering_average();
  std::vector<Surface> surfaces = {};

  explicit Known(const std::vector<std::pair<std::string, double>>& named) {
    for (const auto& [name, yaw_slip] : named) {
      Surface surface{.name = name, .seconds = 80.0, .segments = 40, .visits = 1};
      surface.memories[kJoint] = tests::surface_memories({yaw_slip}).front();
      surfaces.push_back(surface);
    }
    tests::drive_on_surface(average, named.front().second, 75);
  }
  LearnedSlip slip() { return {.averages = {&average, nullptr, nullptr}, .leader = kJoint, .law = kWhiteSlip}; }
};

SurfaceSettings remembering() {
  SurfaceSettings settings;
  settings.remember = true;
  return settings;
}

std::vector<std::string> names(const SurfaceBank& bank) {
  std::vector<std::string> all;
  for (const Surface& surface : bank.surfaces()) {
    all.push_back(surface.name);
  }
  return all;
}

TEST_CASE("at a start every surface competes beside a new one, and a label makes its own likelier") {
  for (const std::string label : {"", "hall"}) {
    Known known({{"hall", -0.1}, {"sand", -0.5}});
    SurfaceBank bank(remembering());
    bank.know(known.surfaces, {});
    bank.start_drive(known.slip(), {.label = label, .date = ""});
    CHECK_FALSE(bank.present());
    const auto found = bank.probabilities();
    REQUIRE(found.size() == 3);
    CHECK(found[0].name == "hall");
    CHECK((found[0].probability > 0.5) == !label.empty());
    CHECK(found[1].name.empty());  // what is like one of both, and a new one
    CHECK(found[1].probability <= 0.2 + 1e-12);
    CHECK(found[2].name == "sand");
  }
}

TEST_CASE("the surface that is driven on is recalled, its visit counted, and a label that named it was right") {
  Known known({{"hall", -0.1}, {"sand", -0.5}});
  SurfaceBank bank(remembering());
  bank.know(known.surfaces, {});
  const double before = bank.labels().reliability();
  bank.start_drive(known.slip(), {.label = "sand", .date = "2026-01-01"});
  tests::drive_on_surface(known.average, -0.5, 76, 8, [&] { bank.consider(known.slip()); });
  REQUIRE(bank.present());
  CHECK(bank.surfaces()[*bank.present()].name == "sand");
  CHECK(bank.surfaces()[*bank.present()].visits == 2);
  CHECK(bank.labels().reliability() > before);
  const auto events = bank.take_events();
  REQUIRE(events.size() == 1);
  CHECK(events.front().kind == SurfaceEvent::Kind::Recalled);
  CHECK(bank.take_events().empty());
  bank.hear(known.slip(), {.classes = {"sand", "ice"}, .probability = Eigen::Vector2d(0.9, 0.1), .unknown = 0.0});
  CHECK(bank.probabilities().size() == 2);  // against what is like it, which an answer that says the same does not end
}

TEST_CASE(
    "where nothing competes the surface under the robot is certain, and candidates without a name count together") {
  Known known({{"hall", -0.1}, {"sand", -0.5}});
  SurfaceBank bank(remembering());
  REQUIRE(bank.probabilities().size() == 1);
  CHECK(bank.probabilities().front().name.empty());
  CHECK(bank.probabilities().front().probability == 1.0);
  bank.know(known.surfaces, {});
  bank.cue(known.slip(), "ice");  // the present one, what became of it, and a new one have no name
  const auto found = bank.probabilities();
  REQUIRE(found.size() == 3);
  CHECK(found[0].name.empty());
  CHECK(found[0].probability + found[1].probability + found[2].probability == doctest::Approx(1.0));
}

TEST_CASE("surfaces that come back are predicted from the first segments on, and one that does not costs nothing") {
  for (const double yaw_slip : {-0.5, -0.1}) {
    Known known({{"hall", -0.1}, {"sand", -0.5}});
    RememberingAverage goes_on = known.average;
    SurfaceBank bank(remembering());
    bank.know(known.surfaces, {});
    bank.start_drive(known.slip(), {});
    tests::drive_on_surface(known.average, yaw_slip, 78, 3);
    tests::drive_on_surface(goes_on, yaw_slip, 78, 3);
    const double recalled = std::abs(known.average.average().state().estimate.mean[1] - yaw_slip);
    CHECK(recalled < 0.03);
    CHECK(recalled < std::abs(goes_on.average().state().estimate.mean[1] - yaw_slip) + 0.01);
  }
}

TEST_CASE("what is added is merged with what it cannot be told from, and a name that is taken gets a number") {
  Known known({{"surface 1", -0.1}, {"surface 2", -0.5}});
  SurfaceBank bank(remembering());
  bank.know({known.surfaces[0]}, {});
  Surface another = known.surfaces[1];
  another.name = "surface 1";
  CHECK(bank.add(known.slip(), {another}) == std::vector<std::string>{"surface 1 (2)"});
  CHECK(names(bank) == std::vector<std::string>{"surface 1", "surface 1 (2)"});
  Surface same = known.surfaces[1];
  same.name = "sand";
  bank.add(known.slip(), {same});
  REQUIRE(bank.surfaces().size() == 2);
  CHECK(bank.surfaces()[1].segments == 80);
  CHECK(bank.surfaces()[1].visits == 2);
}

TEST_CASE("without a memory nothing is counted, opened or kept") {
  Known known({{"hall", -0.1}});
  SurfaceBank bank{SurfaceSettings{}};
  bank.start_drive(known.slip(), {.label = "hall", .date = ""});
  bank.keep_present(known.slip());
  bank.consider(known.slip());
  CHECK(bank.surfaces().empty());
  CHECK(bank.take_events().empty());
}

}  // namespace
}  // namespace slipwise
