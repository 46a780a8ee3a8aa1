// SPDX-License-Identifier: Apache-2.0
// Copies of a curve that compete from run to run.
#include "slipwise/identify/curve_bank.hpp"

#include <doctest/doctest.h>

#include <random>
#include <stdexcept>

#include "slipwise/archive/reader.hpp"
#include "slipwise/archive/writer.hpp"

namespace slipwise {
namespace {

constexpr double kNoise = 0.05;

/// A curve of one increment, with two lags that do not differ.
CurveCopies line() {
  return CurveCopies(
      CurveBank(2, Eigen::VectorXd::Constant(1, 1.0), Eigen::VectorXd::Constant(1, 1.0), kNoise, Eigen::Index{0}));
}

/// A run of examples of `output = slope * x`.
void run(CurveCopies& curve, double slope, int examples, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> input(0.2, 1.0);
  std::normal_distribution<double> noise(0.0, kNoise);
  curve.start_run();
  for (int i = 0; i < examples; ++i) {
    const double x = input(random);
    curve.learn(Eigen::MatrixXd::Constant(2, 1, x), slope * x + noise(random));
    if (i % 5 == 4) {
      curve.solve();
    }
  }
}

TEST_CASE("the first run has one copy, and a run in which nothing was learned adds none") {
  CurveCopies curve = line();
  CHECK(curve.copies().size() == 1);
  run(curve, 2.0, 100, 1);
  CHECK(curve.copies().size() == 1);
  curve.start_run();
  CHECK(curve.copies().size() == 2);
  curve.start_run();
  CHECK(curve.copies().size() == 2);
}

TEST_CASE("where a run is like those before it, the copy that knows them goes on") {
  CurveCopies curve = line();
  run(curve, 2.0, 200, 1);
  run(curve, 2.0, 200, 2);
  CHECK(curve.copies().heaviest() == 0);
  CHECK(curve.heaviest().examples() == 400.0);
  CHECK(curve.heaviest().weights()[0] == doctest::Approx(2.0).epsilon(0.02));
}

TEST_CASE("where the curve is another one, that which began with the run leads soon, and goes on") {
  CurveCopies curve = line(), alone = line();
  run(curve, 3.0, 1000, 1);
  run(curve, 1.5, 60, 2);
  run(alone, 1.5, 60, 2);
  CHECK(curve.heaviest().examples() == 60.0);
  CHECK(curve.heaviest().weights() == alone.heaviest().weights());
  run(curve, 1.5, 60, 3);
  CHECK(curve.heaviest().examples() == 120.0);
}

TEST_CASE("there are three copies at most") {
  CurveCopies curve = line();
  for (unsigned seed = 1; seed <= 8; ++seed) {
    run(curve, seed % 2 == 0 ? 1.0 : 2.0, 40, seed);
    CHECK(curve.copies().size() <= 3);
  }
}

TEST_CASE("copies are saved, and go on from there to the byte") {
  CurveCopies curve = line();
  run(curve, 3.0, 200, 1);
  run(curve, 1.5, 30, 2);
  archive::Writer saved, whole, loaded;
  saved(curve);
  CurveCopies other;
  archive::Reader reader(saved.bytes());
  reader(other);
  CHECK_NOTHROW(other.check_loaded(line()));
  CHECK_THROWS_AS(
      CurveCopies(CurveBank(1, Eigen::VectorXd::Ones(2), Eigen::VectorXd::Ones(2), kNoise, 0)).check_loaded(line()),
      std::invalid_argument);
  run(curve, 1.5, 30, 3);
  run(other, 1.5, 30, 3);
  whole(curve);
  loaded(other);
  CHECK(whole.bytes() == loaded.bytes());
}

}  // namespace
}  // namespace slipwise
