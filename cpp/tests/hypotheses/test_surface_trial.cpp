// SPDX-License-Identifier: Apache-2.0
// Surfaces that compete: their segments decide.
#include "slipwise/hypotheses/surface_trial.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "hypotheses/surfaces_learned.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

using Kind = SurfaceCandidate::Kind;
using tests::drive_on_surface;
using tests::kWhiteSlip;
using tests::remembering_average;
using tests::surface_memories;

constexpr double kNow = std::numeric_limits<double>::infinity();
const std::vector<SurfaceCandidate> kAny{{.kind = Kind::Known, .place = 0, .prior = 0.4},
                                         {.kind = Kind::Known, .place = 1, .prior = 0.4},
                                         {.kind = Kind::New, .prior = 0.2}};

TEST_CASE("before any segment speaks, candidates have their priors, and log factors multiply their odds") {
  SurfaceTrial trial(kAny, surface_memories({-0.1, -0.5}), remembering_average(), kWhiteSlip, kNow);
  CHECK(trial.probabilities().isApprox(Eigen::Vector3d(0.4, 0.4, 0.2)));
  trial.weigh(Eigen::Vector3d(0.0, std::log(4.0), std::log(2.0)));
  CHECK(trial.probabilities().isApprox(Eigen::Vector3d(1.0, 4.0, 1.0) / 6.0, 1e-9));
}

TEST_CASE("the surface that is driven on wins, known or new, and each segment speaks once") {
  const auto known = surface_memories({-0.1, -0.5});
  for (const auto& [slip, winner] : {std::pair{-0.1, 0}, {-0.5, 1}, {0.4, 2}}) {
    RememberingAverage average = remembering_average();
    SurfaceTrial trial(kAny, known, average, kWhiteSlip, kNow);
    drive_on_surface(average, slip, 71, 6, [&] {
      trial.follow(average);
      trial.follow(average);
    });
    CHECK(trial.segments() == 6);
    CHECK(trial.probabilities()[winner] > 0.99);
  }
}

TEST_CASE("surfaces are as far apart as their segments would tell, in whichever order, and one is not from itself") {
  const auto known = surface_memories({-0.1, -0.13, -0.5});
  RememberingAverage average = remembering_average();
  CHECK(average.apart(known[0], known[2], kWhiteSlip) == 0.0);  // nothing was driven that could tell
  drive_on_surface(average, -0.1, 72);
  CHECK(average.apart(known[0], known[0], kWhiteSlip) == 0.0);
  const double far = average.apart(known[0], known[2], kWhiteSlip);
  CHECK(far > 10.0 * average.apart(known[0], known[1], kWhiteSlip));
  CHECK(far == doctest::Approx(average.apart(known[2], known[0], kWhiteSlip)).epsilon(0.05));
}

TEST_CASE("what was known at parting is without the segments on another surface") {
  RememberingAverage average = remembering_average();
  drive_on_surface(average, -0.1, 73, 20);
  const SurfaceMemory before = average.average().remember();
  average.forget_recent();
  average.mark_parting(kNow);
  CHECK(present(average.parting()).slips.back().mean == before.slips.back().mean);
  drive_on_surface(average, -0.5, 74, 3);
  average.mark_parting(0.0);  // of the drive, which begins at 0.5 s
  CHECK(present(average.parting()).slips.back().mean == before.slips.back().mean);
  CHECK(average.average().remember().slips.back().mean != before.slips.back().mean);
}

}  // namespace
}  // namespace slipwise
