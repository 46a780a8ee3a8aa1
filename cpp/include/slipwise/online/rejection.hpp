// SPDX-License-Identifier: Apache-2.0
// Why a measurement is rejected, and how many were.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slipwise {

/// Which stream a measurement came from.
enum class Stream : std::uint8_t { Command, Wheels, Pose, Attitude, Force, Reading };
inline constexpr std::size_t kStreams = 6;
constexpr std::size_t enumerators(Stream /*type*/) { return kStreams; }

/// Why a measurement, or a segment, was rejected.
enum class Reason : std::uint8_t {
  NotFinite,
  ImpossibleStamp,
  DuplicateStamp,
  BackwardStamp,
  TooLate,
  AbsurdSpeed,
  PoseOutlier,
  PoseJump,
  LatePose,
  UnknownInput,
  StandingStill,
  AmbiguousHeading,
  NoCourse,
  NoFix,
  PoorPose,
  SteepAttitude,
  ForceBesideAttitude
};
inline constexpr std::size_t kReasons = 17;
constexpr std::size_t enumerators(Reason /*type*/) { return kReasons; }

/// A short stable name, such as "duplicate-stamp".
std::string_view reason_name(Reason reason);
/// The reason in words.
std::string_view reason_text(Reason reason);

/// How many measurements of each stream were rejected, by reason.
using RejectionCounts = std::array<std::array<std::size_t, kReasons>, kStreams>;

}  // namespace slipwise
