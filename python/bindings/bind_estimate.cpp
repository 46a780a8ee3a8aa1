// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/estimate.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "slipwise/estimate/batch.hpp"
#include "slipwise/estimate/iekf.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_estimate(nb::module_& m) {
  nb::class_<Estimate>(m, "Estimate", "Gaussian belief about a parameter vector.")
      .def(nb::init<Eigen::VectorXd, Eigen::MatrixXd>(), "mean"_a, "covariance"_a)
      .def_ro("mean", &Estimate::mean)
      .def_ro("covariance", &Estimate::covariance);
  nb::enum_<Status>(m, "Status")
      .value("Converged", Status::Converged)
      .value("Downweighted", Status::Downweighted)
      .value("Rejected", Status::Rejected)
      .value("NotConverged", Status::NotConverged);
  m.def("advice", &advice, "status"_a, "What the status means and what to do about it.");
  nb::class_<IekfSettings>(m, "IekfSettings")
      .def(nb::init<>())
      .def_rw("iterations", &IekfSettings::iterations)
      .def_rw("halvings", &IekfSettings::halvings)
      .def_rw("huber", &IekfSettings::huber)
      .def_rw("gate", &IekfSettings::gate);
  nb::class_<IekfUpdate>(m, "IekfUpdate")
      .def_ro("estimate", &IekfUpdate::estimate)
      .def_ro("innovation", &IekfUpdate::innovation)
      .def_ro("innovation_covariance", &IekfUpdate::innovation_covariance)
      .def_ro("nis", &IekfUpdate::nis)
      .def_ro("weight", &IekfUpdate::weight)
      .def_ro("status", &IekfUpdate::status);
  m.def("iekf_update", &iekf_update, "model"_a, "prior"_a, "inputs"_a, "segment"_a, "noise"_a, "settings"_a);
}

}  // namespace slipwise::bindings
