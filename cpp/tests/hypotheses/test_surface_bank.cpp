// SPDX-License-Identifier: Apache-2.0
// The surfaces that are kept, what they are called, and which of them compete at a start.
#include "slipwise/hypotheses/surface_bank.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "hypotheses/surfaces_learned.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

using tests::kWhiteSlip;

/// Surfaces of these yaw slips, each driven for 40 segments, and an average that has driven.
struct Known {
  ModelAverage average = tests::remembering_average();
  std::vector<Surface> surfaces = {};

  explicit Known(const std::vector<std::pair<std::string, double>>& named) {
    for (const auto& [name, yaw_slip] : named) {
      Surface surface{.name = name, .seconds = 80.0, .segments = 40, .visits = 1};
      surface.memories[kJoint] = tests::surface_memories({yaw_slip}).front();
      surfaces.push_back(surface);
    }
    tests::drive_on_surface(average, named.front().second, 75);
  }
  Averages averages() { return {&average, nullptr, nullptr}; }
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
    bank.start_drive(known.averages(), kWhiteSlip, {.label = label, .date = ""});
    CHECK_FALSE(bank.present());
    const SurfaceTrial& trial = present(known.average.trial());
    REQUIRE(trial.candidates.size() == 3);
    CHECK(trial.probabilities()[2] <= 0.2 + 1e-12);
    CHECK((trial.probabilities()[0] > 0.5) == !label.empty());
  }
}

TEST_CASE("the surface that is driven on is recalled, its visit counted, and a label that named it was right") {
  Known known({{"hall", -0.1}, {"sand", -0.5}});
  SurfaceBank bank(remembering());
  bank.know(known.surfaces, {});
  const double before = bank.label_reliability();
  bank.start_drive(known.averages(), kWhiteSlip, {.label = "sand", .date = "2026-01-01"});
  tests::drive_on_surface(known.average, -0.5, 76, 8);
  CHECK(bank.consider(known.averages(), kJoint, kWhiteSlip));
  REQUIRE(bank.present());
  CHECK(bank.surfaces()[*bank.present()].name == "sand");
  CHECK(bank.surfaces()[*bank.present()].visits == 2);
  CHECK(bank.label_reliability() > before);
  const auto events = bank.take_events();
  REQUIRE(events.size() == 1);
  CHECK(events.front().kind == SurfaceEvent::Kind::Recalled);
  CHECK(bank.take_events().empty());
}

TEST_CASE("what is added is merged with what it cannot be told from, and a name that is taken gets a number") {
  Known known({{"surface 1", -0.1}, {"surface 2", -0.5}});
  SurfaceBank bank(remembering());
  bank.know({known.surfaces[0]}, {});
  Surface another = known.surfaces[1];
  another.name = "surface 1";
  CHECK(bank.add(known.averages(), kWhiteSlip, {another}, kJoint) == std::vector<std::string>{"surface 1 (2)"});
  CHECK(names(bank) == std::vector<std::string>{"surface 1", "surface 1 (2)"});
  Surface same = known.surfaces[1];
  same.name = "sand";
  bank.add(known.averages(), kWhiteSlip, {same}, kJoint);
  REQUIRE(bank.surfaces().size() == 2);
  CHECK(bank.surfaces()[1].segments == 80);
  CHECK(bank.surfaces()[1].visits == 2);
}

TEST_CASE("without a memory nothing is counted, opened or kept") {
  Known known({{"hall", -0.1}});
  SurfaceBank bank{SurfaceSettings{}};
  bank.start_drive(known.averages(), kWhiteSlip, {.label = "hall", .date = ""});
  bank.keep_present(known.averages(), kWhiteSlip);
  CHECK_FALSE(bank.consider(known.averages(), kJoint, kWhiteSlip));
  CHECK(bank.surfaces().empty());
  CHECK(bank.take_events().empty());
}

}  // namespace
}  // namespace slipwise
