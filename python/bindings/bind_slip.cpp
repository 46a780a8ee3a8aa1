// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/slip.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/slip/basis.hpp"
#include "slipwise/slip/force_terms.hpp"
#include "slipwise/slip/mixed_ahead.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

std::vector<std::string> texts(const Basis& basis, Channel channel) {
  std::vector<std::string> result;
  for (std::size_t i = basis.begin(channel); i < basis.end(channel); ++i) {
    result.push_back(basis.terms()[i].text());
  }
  return result;
}

}  // namespace

void bind_slip(nb::module_& m) {
  using Texts = std::vector<std::string>;
  nb::class_<SlipState>(m, "SlipState", "What slip depends on: v [m/s], omega [rad/s], gx, gy [m/s^2], vy [m/s].")
      .def(nb::init<double, double, double, double>(), "v"_a, "omega"_a, "gx"_a, "gy"_a)
      .def(nb::init<double, double, double, double, double>(), "v"_a, "omega"_a, "gx"_a, "gy"_a, "vy"_a);
  nb::class_<Basis>(m, "Basis", "Terms of the forward, sideways and angular slip rates.")
      .def(
          "__init__",
          [](Basis* self, std::string name, const Texts& lon, const Texts& lat, const Texts& ang) {
            new (self) Basis(std::move(name), lon, lat, ang);
          },
          "name"_a, "lon"_a, "lat"_a, "ang"_a)
      .def_prop_ro("name", &Basis::name)
      .def_prop_ro("size", &Basis::size)
      .def_prop_ro("sideways", &Basis::sideways)
      .def_prop_ro("by_heading", &Basis::by_heading, "Whether a term depends on the heading in the frame of the poses.")
      .def_prop_ro("lon", [](const Basis& b) { return texts(b, Channel::Lon); })
      .def_prop_ro("lat", [](const Basis& b) { return texts(b, Channel::Lat); })
      .def_prop_ro("ang", [](const Basis& b) { return texts(b, Channel::Ang); })
      .def(
          "features", [](const Basis& b, const SlipState& state) { return b.linearize_features(state).value; },
          "state"_a, "Feature of every parameter at one state, [parameters].");
  nb::class_<MixedAhead>(m, "MixedAhead", "Slip along a path whose surfaces are known with probabilities.")
      .def(
          "__init__",
          [](MixedAhead* self, const std::vector<double>& edges, const Eigen::MatrixXd& probabilities,
             const std::vector<Eigen::VectorXd>& slips, const std::vector<Eigen::MatrixXd>& covariances) {
            if (slips.size() != covariances.size()) {
              throw std::invalid_argument("each surface ahead needs slip and its covariance");
            }
            std::vector<SurfaceMoments> surfaces;
            for (std::size_t i = 0; i < slips.size(); ++i) {
              surfaces.push_back({slips[i], covariances[i]});
            }
            new (self) MixedAhead(mix_ahead(edges, probabilities, surfaces));
          },
          "edges"_a, "probabilities"_a, "slips"_a, "covariances"_a,
          "Edges [m] between stretches, a row of probabilities for each stretch, and the moments of each surface.")
      .def_ro("slip", &MixedAhead::slip, "Where the path begins, [slip].")
      .def_prop_ro("edges", [](const MixedAhead& mixed) { return mixed.ahead.edges; })
      .def_prop_ro(
          "changes", [](const MixedAhead& mixed) { return mixed.ahead.changes; }, "Of slip at each edge.")
      .def_ro("directions", &MixedAhead::directions, "Independent errors of all stretches, [slip, stretches] each.");
  nb::enum_<ForceFrame>(m, "ForceFrame").value("Body", ForceFrame::Body).value("World", ForceFrame::World);
  m.def("with_force", &with_force, "basis"_a, "frame"_a, "The basis with the terms of a force.");
  nb::enum_<ForceAxis>(m, "ForceAxis")
      .value("Ahead", ForceAxis::Ahead)
      .value("Left", ForceAxis::Left)
      .value("Moment", ForceAxis::Moment)
      .value("WorldX", ForceAxis::WorldX)
      .value("WorldY", ForceAxis::WorldY);
  nb::class_<ForceTerm>(m, "ForceTerm", "A term of a force among those of a basis.")
      .def_ro("place", &ForceTerm::place, "Among the parameters.")
      .def_ro("axis", &ForceTerm::axis)
      .def_ro("sign", &ForceTerm::sign, "Of what a positive force does to its channel.");
  m.def("force_terms", &force_terms, "basis"_a, "The terms of a basis that are those of a force.");
  m.def("named_basis", &named_basis, "name"_a, "A basis by its published name.");
  m.def("basis_names", &basis_names, "Names of all bases that ship.");
  m.def(
      "slip_rate",
      [](const Basis& basis, const Eigen::VectorXd& alpha, const SlipState& state) {
        check_size(alpha, static_cast<Eigen::Index>(basis.size()), "a slip rate");
        return slip_rate(basis, alpha, state);
      },
      "basis"_a, "alpha"_a, "state"_a, "Slip rates (m/s, m/s, rad/s) at one state, [3].");
  m.def(
      "slip_rate_covariance",
      [](const Basis& basis, const Eigen::MatrixXd& covariance, const SlipState& state) {
        check_square(covariance, static_cast<Eigen::Index>(basis.size()), "the covariance of slip rates");
        return slip_rate_covariance(basis, covariance, state);
      },
      "basis"_a, "covariance"_a, "state"_a, "Covariance of the slip rates, [3, 3].");
}

}  // namespace slipwise::bindings
