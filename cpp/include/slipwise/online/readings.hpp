// SPDX-License-Identifier: Apache-2.0
// The table of sensors that measure one number: readers of logs, lines and live nodes, bindings and saving go by it.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "slipwise/online/gyro_buffer.hpp"
#include "slipwise/online/reading.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// Each is a type that keeps what was measured of late: what it is called (`kKind`), `push({t, number})`,
/// `measure(segment)`, which adds its rows to a segment, `drop_before(t)`, `restart()` and `archive`.
using ReadingSensors = std::tuple<GyroBuffer>;
inline constexpr std::size_t kReadingKinds = std::tuple_size_v<ReadingSensors>;

template <class... Sensors>
constexpr std::array<ReadingKind, sizeof...(Sensors)> kinds_of(std::type_identity<std::tuple<Sensors...>> /*table*/) {
  return {Sensors::kKind...};
}
inline constexpr std::array<ReadingKind, kReadingKinds> kReadings = kinds_of(std::type_identity<ReadingSensors>{});

/// What all of them measured of late, each in the order of its stamps.
class Readings {
 public:
  void push(const Reading& reading) {
    with_each([&](std::size_t kind, auto& sensor) {
      if (kind == reading.kind) {
        sensor.push({reading.t, reading.value});
      }
    });
  }
  /// Adds to a segment what they measured of it.
  void measure(Segment& segment) const {
    std::apply([&](const auto&... sensor) { (sensor.measure(segment), ...); }, sensors_);
  }
  void drop_before(double t) {
    with_each([t](std::size_t /*kind*/, auto& sensor) { sensor.drop_before(t); });
  }
  /// Another run begins.
  void restart() {
    with_each([](std::size_t /*kind*/, auto& sensor) { sensor.restart(); });
  }

  GyroBuffer& gyro() { return std::get<GyroBuffer>(sensors_); }
  const GyroBuffer& gyro() const { return std::get<GyroBuffer>(sensors_); }
  static bool of_gyro(const Reading& reading) { return kReadings[reading.kind].column == GyroBuffer::kKind.column; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    std::apply([&](auto&... sensor) { a(sensor...); }, self.sensors_);
  }

 private:
  template <class Use>
  void with_each(const Use& use) {
    std::size_t kind = 0;
    std::apply([&](auto&... sensor) { (use(kind++, sensor), ...); }, sensors_);
  }

  ReadingSensors sensors_;
};

}  // namespace slipwise
