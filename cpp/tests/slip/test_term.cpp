// SPDX-License-Identifier: Apache-2.0
// Slip terms: reading, spelling, refusing, values and derivatives.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "finite_difference.hpp"
#include "slipwise/slip/term.hpp"

namespace slipwise {
namespace {

double value(const std::string& text, const SlipState& state) { return Term::parse(text).value(SlipQuantities(state)); }

const SlipState kState{.v = -0.7, .omega = 1.3, .gx = 0.4, .gy = -0.2};

TEST_CASE("terms have the value that their text says") {
  CHECK(value("V", kState) == -0.7);
  CHECK(value("V*abs(w)", kState) == doctest::Approx(-0.91));
  CHECK(value("sgn(V)*w^2", kState) == doctest::Approx(-1.69));
  CHECK(value("abs(V)*V*w/g", kState) == doctest::Approx(0.7 * -0.7 * 1.3 / kStandardGravity));
  CHECK(value("gx", kState) == 0.4);
  CHECK(value("2*gy*V", kState) == doctest::Approx(0.28));
  CHECK(value("w/4", kState) == doctest::Approx(0.325));
  CHECK(value("kappa", kState) == doctest::Approx(1.3 / -0.7).epsilon(1e-3));
}

TEST_CASE("spaces and the order of factors do not matter") {
  CHECK(Term::parse(" V * w").text() == Term::parse("w*V").text());
  CHECK(Term::parse("w*V*w").text() == Term::parse("V*w^2").text());
  CHECK(Term::parse("V/g").text() == "V/g");
}

TEST_CASE("a term reads its own spelling back") {
  const std::vector<std::string> texts{"V",        "w",         "V*abs(w)", "sgn(V)*w^2", "abs(V)*V*w/g", "kappa*V",
                                       "kappa^2",  "gx",        "gy*w",     "V*0.1",      "w/3",          "1e20*V",
                                       "V*w*1e-7", "-2*V",      "V/g/g",    "g*V",        "V^8",          "2*V/g",
                                       "V*w/g^2",  "abs(w)*gx", "3e-300*w"};
  for (const std::string& text : texts) {
    CAPTURE(text);
    const Term once = Term::parse(text);
    const Term twice = Term::parse(once.text());
    CHECK(twice.text() == once.text());
    CHECK(twice.value(SlipQuantities(kState)) == once.value(SlipQuantities(kState)));
  }
}

TEST_CASE("terms that move a parked robot are refused") {
  for (const std::string text : {"1", "2.5", "g", "sgn(V)", "sgn(V)^2", "3*sgn(V)"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(Term::parse(text), doctest::Contains("does not vanish when the robot is parked"),
                         std::invalid_argument);
  }
}

TEST_CASE("unknown factors are refused by name") {
  for (const std::string text : {"speed", "v", "W", "abs(x)", "V+w", "V-w", "2V", "V*inf", "V*nan", "V*0", "V**w", "V*",
                                 "*V", "", "/V", "V^2*()", "V(w)"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(Term::parse(text), doctest::Contains("unknown factor"), std::invalid_argument);
  }
  CHECK_THROWS_WITH(Term::parse("V*speed"), doctest::Contains("'speed'"));
}

TEST_CASE("division by a quantity that may be zero is refused") {
  CHECK_THROWS_WITH_AS(Term::parse("w/V"), doctest::Contains("divides by 'V'"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(Term::parse("V*w/abs(w)"), doctest::Contains("divides by 'abs(w)'"), std::invalid_argument);
}

TEST_CASE("powers that are not whole numbers from 1 to 8 are refused") {
  for (const std::string text : {"V^0", "V^-1", "V^9", "V^1.5", "V^", "V^x"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(Term::parse(text), doctest::Contains("power"), std::invalid_argument);
  }
}

TEST_CASE("a number too large or too small to be kept is refused") {
  CHECK_THROWS_AS(Term::parse("V*1e300*1e300"), std::invalid_argument);
  CHECK_THROWS_AS(Term::parse("V*1e300^2"), std::invalid_argument);
  CHECK_THROWS_AS(Term::parse("V/1e300/1e300"), std::invalid_argument);
}

TEST_CASE("curvature stays finite when the speed crosses zero") {
  CHECK(value("kappa", {.v = 0.0, .omega = 2.0}) == 0.0);
  CHECK(std::abs(value("kappa", {.v = 1e-3, .omega = 1.0})) <= 0.5 / kCurvatureSpeed);
}

TEST_CASE("gravity moves only a robot that moves") {
  CHECK(value("gx", {.v = 0.0, .omega = 0.0, .gx = 3.0}) == 0.0);
  CHECK(value("gx", {.v = 0.0, .omega = 0.1, .gx = 3.0}) == 3.0);
}

TEST_CASE("derivatives of terms are their derivatives by speed and yaw rate") {
  const std::vector<std::string> texts{"V",       "w",    "abs(V)",  "abs(w)",  "V*abs(w)",     "sgn(V)*w^2", "kappa",
                                       "kappa*V", "gx*V", "kappa^2", "V^3*w^2", "abs(V)*V*w/g", "-0.3*w^8",   "gy"};
  for (const std::string& text : texts) {
    for (const Eigen::Vector2d& drive : {Eigen::Vector2d(0.9, 0.6), {-1.4, 0.3}, {0.5, -1.1}, {-0.4, -0.8}}) {
      CAPTURE(text);
      const Term term = Term::parse(text);
      const auto at = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(1,
                                         term.value(SlipQuantities({.v = d[0], .omega = d[1], .gx = 0.3, .gy = 0.7})));
      };
      const auto derivatives = term.linearize(SlipQuantities({.v = drive[0], .omega = drive[1], .gx = 0.3, .gy = 0.7}));
      const Eigen::RowVector2d analytic(derivatives.by_v, derivatives.by_omega);
      CHECK(derivatives.value == doctest::Approx(at(drive)[0]).epsilon(1e-14));
      CHECK(tests::jacobian_error(analytic, tests::finite_difference(at, drive, 0.01)) < tests::kDerivativeTolerance);
    }
  }
}

TEST_CASE("terms of sideways speed have their values and exact derivatives, and vanish without it") {
  const SlipState aside{.v = 0.3, .omega = 0.0, .gx = 0.0, .gy = 0.0, .vy = -0.4};
  CHECK(value("Vy", aside) == -0.4);
  CHECK(value("abs(Vy)*V", aside) == doctest::Approx(0.12));
  CHECK(value("V3", aside) == doctest::Approx(0.5 * std::sin(3.0 * std::atan2(-0.4, 0.3))).epsilon(1e-3));
  for (const std::string text : {"Vy", "abs(Vy)", "V3", "V*Vy", "V3*w"}) {
    CAPTURE(text);
    const Term term = Term::parse(text);
    CHECK(term.sideways());
    CHECK(value(text, {.v = 0.7, .omega = 0.2}) == 0.0);
    for (const Eigen::Vector3d& drive : {Eigen::Vector3d(0.9, 0.6, 0.5), {-0.4, 0.3, -0.8}, {0.0, 0.1, 0.7}}) {
      const auto at = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(1, term.value(SlipQuantities({.v = d[0], .omega = d[1], .vy = d[2]})));
      };
      const auto found = term.linearize(SlipQuantities({.v = drive[0], .omega = drive[1], .vy = drive[2]}));
      const Eigen::RowVector3d analytic(found.by_v, found.by_omega, found.by_vy);
      CHECK(tests::jacobian_error(analytic, tests::finite_difference(at, drive, 0.01)) < tests::kDerivativeTolerance);
    }
  }
  CHECK_FALSE(Term::parse("V*w").sideways());
}

}  // namespace
}  // namespace slipwise
