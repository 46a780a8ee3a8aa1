// SPDX-License-Identifier: Apache-2.0
// The products of a slip program add up to the slip of the basis, and the thesis's quadratics are found.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "sample_bases.hpp"
#include "slipwise/rollout/slip_program.hpp"
#include "slipwise/slip/force_terms.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {
namespace {

double value_of(SlipFactor factor, const SlipState& state) {
  if (factor == SlipFactor::Moving) {
    return state.v != 0.0 || state.vy != 0.0 || state.omega != 0.0 ? 1.0 : 0.0;
  }
  if (factor >= SlipFactor::SideV) {
    const auto place = static_cast<std::size_t>(factor) - static_cast<std::size_t>(SlipFactor::SideV);
    return SlipQuantities(state).value[static_cast<std::size_t>(Quantity::SideV) + place];
  }
  return SlipQuantities(state).value[static_cast<std::size_t>(factor)];  // in the order of Quantity
}

/// The twist, slip and drive, as the products give it.
Eigen::Vector3d evaluate(const SlipProgram& program, const SlipState& state) {
  std::vector<double> values{state.v, state.omega, 1.0};
  for (std::size_t i = kFirstProduct; i < program.products.size(); ++i) {
    values.push_back(values[program.products[i].parent] * value_of(program.products[i].factor, state));
  }
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      twist[static_cast<Eigen::Index>(c)] += program.products[i].fraction[c] * values[i];
    }
  }
  return twist;
}

/// With terms of a sideways speed alone, and mixed with others.
Basis sideways_basis() {
  return {"omni", std::vector<std::string>{"V", "abs(Vy)*V", "V3*V"}, std::vector<std::string>{"Vy", "V3", "w*Vy^2"},
          std::vector<std::string>{"w", "Vy", "abs(Vy)*w", "gy*Vy"}};
}

SlipProgram compiled(const Basis& basis, double gx = 0.0, double gy = 0.0) {
  const Eigen::VectorXd alpha = tests::sample_slip(basis, 9);
  return compile_slip(basis, {alpha.data(), basis.size()}, std::array{gx, gy}, basis.sideways());
}

TEST_CASE("for all bases the products are the drive and its slip, on derivatives and parked too") {
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    const SlipProgram program = compiled(basis, 0.8, -0.5);
    for (const auto& [v, omega] : {std::pair{0.9, 0.4}, {-0.7, 0.6}, {0.0, -0.8}, {0.5, 0.0}, {0.0, 0.0}}) {
      const SlipState state{.v = v, .omega = omega, .gx = 0.8, .gy = -0.5};
      const Eigen::Vector3d wanted =
          Eigen::Vector3d(v, 0.0, omega) + slip_rate(basis, tests::sample_slip(basis, 9), state);
      CHECK((evaluate(program, state) - wanted).norm() < 1e-13);
    }
  }
}

TEST_CASE("with a sideways speed the products are the drive and its slip as well") {
  const Basis basis = sideways_basis();
  const SlipProgram program = compiled(basis, 0.8, -0.5);
  CHECK_FALSE(find_quadratic(program).has_value());
  for (const auto& [v, vy] : {std::pair{0.9, 0.4}, {-0.7, 0.6}, {0.0, -0.8}, {0.5, 0.0}, {0.0, 0.0}}) {
    for (const double omega : {0.0, 0.7}) {
      const SlipState state{.v = v, .omega = omega, .gx = 0.8, .gy = -0.5, .vy = vy};
      const Eigen::Vector3d wanted =
          Eigen::Vector3d(v, vy, omega) + slip_rate(basis, tests::sample_slip(basis, 9), state);
      CHECK((evaluate(program, state) - wanted).norm() < 1e-13);
    }
  }
}

TEST_CASE("a product is computed once, from products before it, and its factors are known to be in use") {
  for (const Basis& basis : tests::all_bases()) {
    const SlipProgram program = compiled(basis);
    std::set<std::pair<std::size_t, SlipFactor>> observed;
    for (std::size_t i = kFirstProduct; i < program.products.size(); ++i) {
      const SlipProduct& product = program.products[i];
      CHECK(product.parent < i);
      CHECK(observed.insert({product.parent, product.factor}).second);
      CHECK((program.factors & bit(product.factor)) != 0U);
    }
  }
}

TEST_CASE("terms of speed and curvature up to the second degree are a quadratic, others are none") {
  const std::vector<std::string> none, ang{"V", "kappa", "kappa*V", "V^2", "kappa^2"};
  const auto quadratic = find_quadratic(compiled(Basis("q", none, none, ang)));
  REQUIRE(quadratic.has_value());
  const std::set<std::size_t> places{quadratic->curvature, quadratic->curvature_squared, quadratic->speed_by_curvature,
                                     quadratic->speed_squared};
  CHECK(places.size() == 4);
  CHECK_FALSE(places.contains(kProductOne));
  const std::vector<std::string> cubic{"V^3"}, spinning{"w"};
  CHECK_FALSE(find_quadratic(compiled(Basis("c", none, none, cubic))).has_value());
  CHECK_FALSE(find_quadratic(compiled(Basis("w", spinning, none, none))).has_value());
  CHECK(find_quadratic(compiled(Basis("a", none, none, spinning))).has_value());
}

TEST_CASE("a basis with more products than a kernel has room for is refused") {
  std::vector<std::string> terms, none;
  for (int i = 1; i <= 70; ++i) {
    terms.push_back("V^" + std::to_string(i));
  }
  CHECK_THROWS_AS(compiled(Basis("long", terms, none, none)), std::invalid_argument);
}

TEST_CASE("a force that is fixed to the map is refused: rollouts know no heading there") {
  const Basis windy = with_force(named_basis("edd-2"), ForceFrame::World);
  const std::vector<double> alpha(windy.size(), 0.01);
  CHECK_THROWS_AS(compile_slip(windy, alpha, std::nullopt, false), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
