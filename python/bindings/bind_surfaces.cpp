// SPDX-License-Identifier: Apache-2.0
// Bindings of the surfaces that a learner remembers.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "slipwise/hypotheses/surface_bank.hpp"

namespace nb = nanobind;

namespace slipwise::bindings {

void bind_surfaces(nb::module_& m) {
  nb::class_<SurfaceSettings>(m, "SurfaceSettings", "How surfaces are remembered and recalled.")
      .def(nb::init<>())
      .def_rw("remember", &SurfaceSettings::remember)
      .def_rw("false_alarm", &SurfaceSettings::false_alarm)
      .def_rw("drift", &SurfaceSettings::drift)
      .def_rw("soonest", &SurfaceSettings::soonest)
      .def_rw("learning_rate", &SurfaceSettings::learning_rate)
      .def_rw("trial", &SurfaceSettings::trial)
      .def_rw("fewest", &SurfaceSettings::fewest)
      .def_rw("changed", &SurfaceSettings::changed)
      .def_rw("unknown", &SurfaceSettings::unknown)
      .def_rw("merge", &SurfaceSettings::merge)
      .def_rw("most", &SurfaceSettings::most);
  nb::class_<Surface>(m, "Surface", "A surface that is remembered.")
      .def(nb::init<>())
      .def_ro("name", &Surface::name)
      .def_ro("seconds", &Surface::seconds)
      .def_ro("segments", &Surface::segments)
      .def_ro("visits", &Surface::visits)
      .def_ro("last_seen", &Surface::last_seen)
      .def_prop_ro("speeds", [](const Surface& surface) {
        return std::array<double, 2>{surface.speeds.v, surface.speeds.omega};
      });
  nb::class_<SurfaceBank>(m, "SurfaceBank", "The surfaces that are remembered.")
      .def_prop_ro("surfaces", [](const SurfaceBank& bank) { return bank.surfaces(); })
      .def_prop_ro("present", &SurfaceBank::present)
      .def_prop_ro("label_reliability", &SurfaceBank::label_reliability);
  nb::enum_<SurfaceEvent::Kind>(m, "SurfaceEventKind", "What happened to a surface.")
      .value("Opened", SurfaceEvent::Kind::Opened)
      .value("Recalled", SurfaceEvent::Kind::Recalled)
      .value("Kept", SurfaceEvent::Kind::Kept)
      .value("Merged", SurfaceEvent::Kind::Merged)
      .value("Dropped", SurfaceEvent::Kind::Dropped);
  nb::class_<SurfaceEvent>(m, "SurfaceEvent", "Something that happened to a surface.")
      .def_ro("kind", &SurfaceEvent::kind)
      .def_ro("name", &SurfaceEvent::name)
      .def_ro("other", &SurfaceEvent::other)
      .def_ro("probability", &SurfaceEvent::probability)
      .def_ro("segments", &SurfaceEvent::segments);
}

}  // namespace slipwise::bindings
