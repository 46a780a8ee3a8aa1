// SPDX-License-Identifier: Apache-2.0
// Measurements of any kind, and what is measured beside inputs and poses: attitudes, forces, yaw rates.
#include <array>
#include <optional>
#include <variant>

#include "slipwise/online/segment_stream.hpp"

namespace slipwise {

void SegmentStream::push(const Measurement& measurement) {
  std::visit(Takes{[&](const CommandSample& command) { push_command(command.sample); },
                   [&](const WheelSample& wheels) { push_wheels(wheels.sample); },
                   [&](const KnownForce& force) { push_force(force); }, [&](const Tilt& tilt) { push_attitude(tilt); },
                   [&](const MeasuredPose& pose) { push_pose(pose); }, [&](const YawRate& rate) { push_gyro(rate); }},
             measurement);
}

std::optional<Tilt> SegmentStream::push_attitude(const Tilt& measured) {
  std::optional<Tilt> tilt;
  if (arrives(Stream::Attitude, measured.t, std::array{measured.roll, measured.pitch})) {
    tilt = attitudes_.level(measured);
    if (tilt) {
      tilts_.push(*tilt);
    } else {
      reject(Stream::Attitude, Reason::SteepAttitude, measured.t);
    }
  }
  advance(newest_ - settings_.latency);
  return tilt;
}

void SegmentStream::push_force(const KnownForce& force) {
  if (arrives(Stream::Force, force.t, std::array{force.x, force.y})) {
    if (tilts_.empty()) {
      forces_.push(force);
    } else {
      reject(Stream::Force, Reason::ForceBesideAttitude, force.t);
    }
  }
  advance(newest_ - settings_.latency);
}

void SegmentStream::push_gyro(const YawRate& sample) {
  if (arrives(Stream::Gyro, sample.t, std::array{sample.rate})) {
    gyro_.push(sample);
    evidence_.push_gyro(sample);
    if (settings_.heading_only) {
      turn_on(sample);
    }
  }
  advance(newest_ - settings_.latency);
}

}  // namespace slipwise
