// SPDX-License-Identifier: Apache-2.0
// The reasons by name and in words.
#include "slipwise/online/rejection.hpp"

namespace slipwise {
namespace {

struct Words {
  std::string_view name;
  std::string_view text;
};

constexpr std::array<Words, kReasons> kWords{{
    {.name = "incomplete", .text = "a number is missing or impossible"},
    {.name = "bad-stamp", .text = "the stamp is no time in seconds"},
    {.name = "duplicate-stamp", .text = "the stamp is that of the one before"},
    {.name = "backward-stamp", .text = "the stamp goes backward"},
    {.name = "too-late", .text = "it arrived later than the latency allowed between streams"},
    {.name = "absurd-speed", .text = "far beyond all speeds before, all at once"},
    {.name = "pose-outlier", .text = "poses far from their neighbours"},
    {.name = "pose-jump", .text = "steps between poses that jump; poses after are in a frame of their own"},
    {.name = "late-pose", .text = "the pose comes after a gap and is late by an unknown time"},
    {.name = "unknown-input", .text = "the input is unknown (older than allowed) for a stretch"},
    {.name = "standing-still", .text = "the robot was commanded to stand still for the whole segment"},
    {.name = "heading-ambiguous", .text = "between two poses the robot may have turned by more than half a turn"},
    {.name = "no-course",
     .text = "positions that tell no course together: the robot hardly moved, or not as its inputs say"},
    {.name = "no-fix", .text = "the satellite receiver says that it has no position"},
    {.name = "poor-pose", .text = "between poses whose errors are far larger than those of the first source"},
    {.name = "steep-attitude",
     .text = "roll and pitch of a sensor that is not mounted level, or of no robot that drives"},
    {.name = "force-beside-attitude",
     .text = "a known force beside roll and pitch, of which gravity follows: one of them must hold all that pushes"},
}};

const Words& words(Reason reason) { return kWords[static_cast<std::size_t>(reason)]; }

}  // namespace

std::string_view reason_name(Reason reason) { return words(reason).name; }
std::string_view reason_text(Reason reason) { return words(reason).text; }

}  // namespace slipwise
