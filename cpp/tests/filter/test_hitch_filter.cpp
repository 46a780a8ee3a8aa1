// SPDX-License-Identifier: Apache-2.0
// A simulated trailer: angle, length and hitch offset are found within what is said of them.
#include "slipwise/filter/hitch_filter.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr Trailer kTrue{.length = 1.4, .hitch_offset = 0.35};
constexpr double kStep = 0.1, kStd = 0.03, kPsd = 1e-4;  // [s], [rad], [rad^2/s]

/// What a filter knows after a drive that weaves, and what is true.
struct Drive {
  HitchFilter filter;
  double psi;
  double nis;  ///< mean, of one number
};

Drive driven(unsigned seed, int steps) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  // The truth is drawn from what the filter thinks before.
  Trailer trailer = kTrue;
  HitchFilterSettings settings{.trailer = kTrue, .length_std = 0.2, .hitch_offset_std = 0.2, .rate_psd = kPsd};
  trailer.length += 0.2 * normal(random) * 0.9;
  trailer.hitch_offset += 0.2 * normal(random) * 0.9;
  Drive drive{.filter = HitchFilter(settings), .psi = 0.5 * normal(random) * 0.5, .nis = 0.0};
  for (int k = 0; k < steps; ++k) {
    const double t = k * kStep;
    const BodyTwist twist{.v = 0.8 + 0.3 * std::sin(0.2 * t), .vy = 0.0, .omega = 0.5 * std::sin(0.45 * t)};
    drive.psi = hitch_after(trailer, drive.psi, twist, kStep).psi + std::sqrt(kPsd * kStep) * normal(random);
    drive.filter.advance(twist, kStep);
    drive.nis += drive.filter.measure(drive.psi + kStd * normal(random), kStd) / steps;
  }
  drive.filter.advance({}, 0.0);
  const Eigen::Vector3d off(drive.filter.psi() - drive.psi, drive.filter.trailer().length - trailer.length,
                            drive.filter.trailer().hitch_offset - trailer.hitch_offset);
  const Eigen::Vector3d std = drive.filter.covariance().diagonal().cwiseSqrt();
  for (int i = 0; i < 3; ++i) {
    CHECK(std::abs(off[i]) < 3.5 * std[i]);
  }
  return drive;
}

TEST_CASE("angle, length and offset of simulated trailers lie within what is said of them, and the errors are honest") {
  double nis = 0.0, squares = 0.0;
  constexpr unsigned kSeeds = 40;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Drive drive = driven(seed, 600);
    nis += drive.nis / kSeeds;
    squares += std::pow(drive.filter.psi() - drive.psi, 2) / drive.filter.covariance()(0, 0) / kSeeds;
    CHECK(std::sqrt(drive.filter.covariance()(1, 1)) < 0.05);
    CHECK(std::sqrt(drive.filter.covariance()(2, 2)) < 0.05);
  }
  CHECK(nis == doctest::Approx(1.0).epsilon(0.05));
  CHECK(squares > 0.5);
  CHECK(squares < 1.6);
}

TEST_CASE("straight on, nothing is learned of the hitch offset") {
  HitchFilter filter({.trailer = kTrue, .length_std = 0.2, .hitch_offset_std = 0.2, .rate_psd = kPsd});
  for (int k = 0; k < 300; ++k) {
    filter.advance({.v = 1.0}, kStep);
    filter.measure(0.0, kStd);
  }
  CHECK(std::sqrt(filter.covariance()(2, 2)) > 0.19);
}

TEST_CASE("an angle is measured round the circle, and impossible ones are refused") {
  HitchFilter filter({.trailer = kTrue});
  filter.measure(2.0 * 3.14159265358979 + 0.1, kStd);
  CHECK(filter.psi() == doctest::Approx(0.1).epsilon(0.05));
  CHECK_THROWS_AS(filter.measure(std::numeric_limits<double>::quiet_NaN(), kStd), std::invalid_argument);
  CHECK_THROWS_AS(filter.measure(0.1, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(HitchFilter({.trailer = {.length = -1.0, .hitch_offset = 0.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
