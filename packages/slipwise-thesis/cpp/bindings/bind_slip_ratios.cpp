// SPDX-License-Identifier: Apache-2.0
// Bindings of slip ratios and the slip angle: an extended Kalman filter and a sliding-mode observer.
#include <nanobind/eigen/dense.h>

#include "slipwise/thesis/sliding_mode_observer.hpp"
#include "slipwise/thesis/slip_ratio_filter.hpp"
#include "thesis_bindings.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
void bind_slip_ratios(nb::module_& m) {
  m.def("slip_ratio_model", &slip_ratio_model, "full-linear-6 behind an identity actuator.");
  nb::class_<SlipRatioFilterSettings>(m, "SlipRatioFilterSettings")
      .def(nb::init<>())
      .def_rw("wheel_separation", &SlipRatioFilterSettings::wheel_separation)
      .def_rw("prior_ratio_std", &SlipRatioFilterSettings::prior_ratio_std)
      .def_rw("prior_angle_std", &SlipRatioFilterSettings::prior_angle_std)
      .def_rw("walk_ratio", &SlipRatioFilterSettings::walk_ratio)
      .def_rw("walk_angle", &SlipRatioFilterSettings::walk_angle)
      .def_rw("huber", &SlipRatioFilterSettings::huber)
      .def_rw("noise", &SlipRatioFilterSettings::noise);
  nb::class_<SlipRatioUpdate>(m, "SlipRatioUpdate", "One segment's update of the slip ratios.")
      .def_ro("innovation", &SlipRatioUpdate::innovation)
      .def_ro("innovation_covariance", &SlipRatioUpdate::innovation_covariance)
      .def_ro("nis", &SlipRatioUpdate::nis)
      .def_ro("weight", &SlipRatioUpdate::weight);
  nb::class_<SlipRatioFilter>(m, "SlipRatioFilter", "Slip ratios and slip angle by an EKF.")
      .def(nb::init<const SlipRatioFilterSettings&>(), "settings"_a)
      .def("learn", &SlipRatioFilter::learn, "wheels"_a, "segment"_a)
      .def_prop_ro("estimate", &SlipRatioFilter::estimate, "Posterior of (left, right, angle).")
      .def("linear_estimate", &SlipRatioFilter::linear_estimate, "The same about full-linear-6.");
  nb::class_<SlidingModeSettings>(m, "SlidingModeSettings")
      .def(nb::init<>())
      .def_rw("wheel_separation", &SlidingModeSettings::wheel_separation)
      .def_rw("ratio_gain", &SlidingModeSettings::ratio_gain)
      .def_rw("angle_gain", &SlidingModeSettings::angle_gain)
      .def_rw("side_layer", &SlidingModeSettings::side_layer)
      .def_rw("drift_layer", &SlidingModeSettings::drift_layer)
      .def_rw("slowest", &SlidingModeSettings::slowest);
  nb::class_<SlidingModeUpdate>(m, "SlidingModeUpdate", "What a segment said to the observer.")
      .def_ro("surface", &SlidingModeUpdate::surface)
      .def_ro("used", &SlidingModeUpdate::used);
  nb::class_<SlidingModeObserver>(m, "SlidingModeObserver", "Slip ratios and slip angle by a sliding-mode observer.")
      .def(nb::init<const SlidingModeSettings&>(), "settings"_a)
      .def("learn", &SlidingModeObserver::learn, "wheels"_a, "segment"_a)
      .def_prop_ro("slip", [](const SlidingModeObserver& o) -> Eigen::Vector3d { return o.slip().vector(); })
      .def("linear_mean", &SlidingModeObserver::linear_mean, "The slip as parameters of full-linear-6.");
}

}  // namespace slipwise::bindings
