// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/identify, the search for a drive's limits.
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>

#include "bindings.hpp"
#include "slipwise/identify/limit_search.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_limits(nb::module_& m) {
  using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
  nb::class_<WheelRecord>(m, "WheelRecord", "Commands without a gap, and wheel twists beside them.")
      .def(
          "__init__",
          [](WheelRecord* self, const InputHistory& commands, Rows wheels) {
            WheelRecord record{.commands = commands, .t = {}, .wheels = {}};
            for (std::size_t i = 0; i < wheels.shape(0); ++i) {
              const double* row = wheels.data() + 3 * i;
              record.t.push_back(row[0]);
              record.wheels.push_back({row[1], 0.0, row[2]});
            }
            if (record.t.empty()) {
              throw std::invalid_argument("a record has no wheel twists; leave it out");
            }
            new (self) WheelRecord(std::move(record));
          },
          "commands"_a, "wheels"_a, "`wheels` are rows of t [s], v [m/s], omega [rad/s].");
  nb::enum_<LimitKind>(m, "LimitKind")
      .value("DeadBand", LimitKind::DeadBand)
      .value("Saturation", LimitKind::Saturation)
      .value("SlewRateUp", LimitKind::SlewRateUp)
      .value("SlewRateDown", LimitKind::SlewRateDown);
  nb::enum_<LimitedAxis>(m, "LimitedAxis", "The commanded speed, the commanded yaw rate, or both sides.")
      .value("Speed", LimitedAxis::Speed)
      .value("YawRate", LimitedAxis::YawRate)
      .value("Side", LimitedAxis::Side);
  nb::class_<FoundLimit>(m, "FoundLimit", "A limit that the data show, with its standard deviation.")
      .def_ro("axis", &FoundLimit::axis)
      .def_ro("kind", &FoundLimit::kind)
      .def_ro("value", &FoundLimit::value)
      .def_ro("std", &FoundLimit::std)
      .def_ro("gain", &FoundLimit::gain);
  nb::class_<AxisReach>(m, "AxisReach", "What the commands reached in an axis.")
      .def_ro("slowest", &AxisReach::slowest)
      .def_ro("fastest", &AxisReach::fastest)
      .def_ro("step", &AxisReach::step);
  nb::class_<LimitSearch>(m, "LimitSearch", "What a search for limits found.")
      .def_prop_ro("limits", [](const LimitSearch& search) { return search.drive.limits; })
      .def_prop_ro("actuator", [](const LimitSearch& search) { return search.drive.actuator; })
      .def_ro("found", &LimitSearch::found)
      .def_ro("wheel_separation_std", &LimitSearch::wheel_separation_std)
      .def_ro("reach", &LimitSearch::reach);
  m.def(
      "find_limits",
      [](const std::vector<WheelRecord>& records, const PriorSettings& prior, double wheel_separation,
         double least_gain, const LimitSearch* before) {
        const auto start = before == nullptr ? std::nullopt : std::optional<LimitedActuator>(before->drive);
        return find_limits(records, prior, wheel_separation, {.least_gain = least_gain}, start);
      },
      "records"_a, "prior"_a, "wheel_separation"_a, "least_gain"_a, "before"_a.none(),
      "The limits that wheel speeds show; the search goes on from those found `before`.");
  m.attr("LEAST_LIMIT_GAIN") = LimitSearchSettings{}.least_gain;
}

}  // namespace slipwise::bindings
