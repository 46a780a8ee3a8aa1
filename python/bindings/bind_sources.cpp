// SPDX-License-Identifier: Apache-2.0
// Bindings of several sources of poses: their settings and estimates.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <string>

#include "bindings.hpp"
#include "pose_sources.hpp"
#include "slipwise/online/known_sources.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

PoseFix pose_fix(std::size_t number) {
  if (number >= kPoseFixes) {
    throw std::invalid_argument("a fix is a number below " + std::to_string(kPoseFixes) + ", got " +
                                std::to_string(number));
  }
  return static_cast<PoseFix>(number);
}

std::vector<LearnedSource> learned_sources(const KnownSources& sources, const Eigen::Vector3d& scale) {
  std::vector<LearnedSource> found;
  for (std::size_t i = 0; i < sources.calibrations().size(); ++i) {
    LearnedSource source{.calibration = sources.calibrations()[i].estimate(),
                         .segments = sources.learned()[i],
                         .noise = Eigen::Matrix<double, Eigen::Dynamic, 3>(kPoseFixes, 3),
                         .seen = std::vector<bool>(kPoseFixes)};
    for (std::size_t fix = 0; fix < kPoseFixes; ++fix) {
      const std::size_t each = noise_class(i, static_cast<PoseFix>(fix));
      source.seen[fix] = sources.noise().met(each);
      source.noise.row(static_cast<Eigen::Index>(fix)) =
          sources.noise().size({each, each}, scale).cwiseQuotient(scale).cwiseSqrt();
    }
    found.push_back(std::move(source));
  }
  return found;
}

void bind_sources(nb::module_& m) {
  nb::class_<SourceSettings>(m, "SourceSettings", "Settings of a pose source before it measures.")
      .def(nb::init<>())
      .def_rw("sensor", &SourceSettings::sensor)
      .def_rw("late", &SourceSettings::late)
      .def_rw("clock_std", &SourceSettings::clock_std)
      .def_rw("sensor_std_xy", &SourceSettings::sensor_std_xy)
      .def_rw("sensor_std_yaw", &SourceSettings::sensor_std_yaw)
      .def_rw("poorest", &SourceSettings::poorest);
  nb::class_<LearnedSource>(m, "LearnedSource", "Estimates of a pose source.")
      .def_ro("calibration", &LearnedSource::calibration, "Lateness [s], x, y [m] and yaw [rad] in base_link.")
      .def_ro("segments", &LearnedSource::segments, "Segments learned between its poses.")
      .def_ro("seen", &LearnedSource::seen, "Of each fix, whether there was a segment; [fixes].")
      .def_ro("noise", &LearnedSource::noise,
              "Of each fix, factors of the standard deviations (x, y, theta) beside the first; [fixes, 3].");
  m.def(
      "fix_names",
      [] {
        std::vector<std::string_view> names;
        for (std::size_t i = 0; i < kPoseFixes; ++i) {
          names.push_back(fix_name(static_cast<PoseFix>(i)));
        }
        return names;
      },
      "Fixes of a satellite receiver by number, in the order in which they become better.");
}

}  // namespace slipwise::bindings
