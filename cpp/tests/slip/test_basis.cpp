// SPDX-License-Identifier: Apache-2.0
// Slip bases: their layout, laws that all of them obey, and which of them respect the mirror.
#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "sample_bases.hpp"
#include "slipwise/slip/basis.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {
namespace {

using Texts = std::vector<std::string>;

std::vector<double> features(const Basis& basis, const SlipState& state) {
  std::vector<double> value(basis.size());
  basis.features(state, value);
  return value;
}

/// Parameters whose feature has the wrong parity in the yaw rate: lon must be even, lat and ang odd.
std::set<std::string> mirror_breakers(const Basis& basis) {
  std::set<std::string> breakers;
  for (const double v : {0.8, -0.6}) {
    const auto left = features(basis, {.v = v, .omega = 0.7, .gx = 0.3, .gy = 0.2});
    const auto right = features(basis, {.v = v, .omega = -0.7, .gx = 0.3, .gy = -0.2});
    for (std::size_t i = 0; i < basis.size(); ++i) {
      const double parity = basis.channel(i) == Channel::Lon ? 1.0 : -1.0;
      if (std::abs(left[i] - parity * right[i]) > 1e-12) {
        breakers.insert(basis.parameter_name(i));
      }
    }
  }
  return breakers;
}

TEST_CASE("the shipped bases have the sizes of the published table") {
  const std::vector<std::pair<std::string, std::size_t>> published{
      {"edd-2", 2},  {"icr-3", 3},   {"drive-5", 5},      {"inertial-5", 5},   {"full-linear-6", 6}, {"ipem-9", 9},
      {"omni-8", 8}, {"drive-9", 9}, {"odd-even-10", 10}, {"odd-even-13", 13}, {"ipem-13", 13},      {"thesis-15", 15}};
  CHECK(basis_names().size() == published.size());
  for (const auto& [name, size] : published) {
    CAPTURE(name);
    CHECK(named_basis(name).size() == size);
    CHECK(named_basis(name).name() == name);
  }
}

TEST_CASE("a parked robot does not slip in any basis, on a derivative either") {
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    for (const double feature : features(basis, {.v = 0.0, .omega = 0.0, .gx = 1.0, .gy = -2.0})) {
      CHECK(feature == 0.0);
    }
  }
}

TEST_CASE("channels and parameter names follow the order lon, lat, ang") {
  const Basis basis = named_basis("drive-5");
  const Texts expected{"lon.V", "lat.V*w", "ang.V*w", "ang.V", "ang.w"};
  for (std::size_t i = 0; i < basis.size(); ++i) {
    CHECK(basis.parameter_name(i) == expected[i]);
  }
  CHECK(basis.begin(Channel::Ang) == 2);
  CHECK(basis.end(Channel::Ang) == 5);
  CHECK(named_basis("edd-2").begin(Channel::Lat) == named_basis("edd-2").end(Channel::Lat));
}

TEST_CASE("parameter names are unique within a basis") {
  for (const Basis& basis : tests::all_bases()) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < basis.size(); ++i) {
      names.insert(basis.parameter_name(i));
    }
    CHECK(names.size() == basis.size());
  }
}

TEST_CASE("features and linearised features agree") {
  const SlipState state{.v = 0.7, .omega = -0.4, .gx = 0.1, .gy = 0.2};
  for (const Basis& basis : tests::all_bases()) {
    const auto value = features(basis, state);
    const SlipFeatures linearized = basis.linearize_features(state);
    for (std::size_t i = 0; i < basis.size(); ++i) {
      CHECK(linearized.value[static_cast<Eigen::Index>(i)] == value[i]);
    }
  }
}

TEST_CASE("in icr-3 the robot turns about a point at a fixed distance ahead of its origin") {
  const Basis basis = named_basis("icr-3");
  const Eigen::Vector3d alpha(-0.05, 0.12, -0.4);
  const double x_icr = -alpha[1] / (1.0 + alpha[2]);  // thesis 2.3 for the true yaw rate
  for (const double v : {0.0, 0.7, -0.4}) {
    for (const double omega : {0.8, -0.3}) {
      const Eigen::Vector3d slip = slip_rate(basis, alpha, {.v = v, .omega = omega});
      CHECK(slip.y() + x_icr * (omega + slip.z()) == doctest::Approx(0.0).epsilon(1e-14));
    }
  }
}

TEST_CASE("a robot and its mirror image slip alike in the bases without odd ones out") {
  // edd-2 and icr-3 alone of the shipped bases are free of terms that break the mirror.
  CHECK(mirror_breakers(named_basis("edd-2")).empty());
  CHECK(mirror_breakers(named_basis("icr-3")).empty());
  CHECK(mirror_breakers(Basis("mirrored", Texts{"V", "w^2"}, Texts{"w", "V*w", "gy"}, Texts{"w*abs(w)"})).empty());
}

TEST_CASE("the terms that break the mirror are those that model a crooked robot") {
  using Names = std::set<std::string>;
  CHECK(mirror_breakers(named_basis("drive-5")) == Names{"ang.V"});
  CHECK(mirror_breakers(named_basis("inertial-5")) == Names{"ang.V"});
  CHECK(mirror_breakers(named_basis("full-linear-6")) == Names{"lon.w", "lat.V", "ang.V"});
  CHECK(mirror_breakers(named_basis("ipem-9")) == Names{"lat.V", "ang.V"});
  CHECK(mirror_breakers(named_basis("odd-even-10")) == Names{"ang.V"});
  CHECK(mirror_breakers(named_basis("ipem-13")) == Names{"lat.V", "ang.V", "ang.gx"});
  CHECK(mirror_breakers(named_basis("thesis-15")) ==
        Names{"lon.kappa", "lon.V*kappa", "lat.V", "lat.V^2", "lat.kappa^2", "ang.V", "ang.V^2", "ang.kappa^2"});
}

TEST_CASE("a term that stands twice in a channel is refused, also when spelt differently") {
  CHECK_THROWS_WITH_AS(Basis("mine", Texts{"V*w", "w*V"}, Texts{}, Texts{}), doctest::Contains("twice in channel lon"),
                       std::invalid_argument);
  CHECK(Basis("mine", Texts{"V"}, Texts{"V"}, Texts{"V"}).size() == 3);
}

TEST_CASE("an unknown basis is refused with the names of those that exist") {
  CHECK_THROWS_WITH_AS(named_basis("odd-even"), doctest::Contains("odd-even-10"), std::invalid_argument);
}

TEST_CASE("a union has every term once and knows where each came from") {
  const std::vector<Basis> parts{named_basis("edd-2"), named_basis("drive-5"), named_basis("ipem-9")};
  const Basis whole = union_basis("all", parts);
  for (const Basis& part : parts) {
    const auto places = parameter_places(part, whole);
    REQUIRE(places.size() == part.size());
    for (std::size_t i = 0; i < part.size(); ++i) {
      CHECK(whole.parameter_name(places[i]) == part.parameter_name(i));
    }
  }
  CHECK(whole.size() == 9);
  CHECK_THROWS_WITH_AS(parameter_places(named_basis("thesis-15"), whole), doctest::Contains("lacks the term"),
                       std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
