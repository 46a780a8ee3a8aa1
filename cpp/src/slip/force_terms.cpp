// SPDX-License-Identifier: Apache-2.0
// Terms of a force, distinguished from those of slip by their spelling.
#include "slipwise/slip/force_terms.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace slipwise {
namespace {

/// A heading turns x and y of the world into the robot's axes: ahead = cos x + sin y, left = cos y - sin x.
struct Known {
  Channel channel;
  std::string_view text;
  ForceAxis axis;
  double sign;
  bool turning;
};

constexpr std::array<Known, 14> kKnown{{
    {Channel::Lon, "abs(V)", ForceAxis::Ahead, 1.0, false},
    {Channel::Lon, "abs(w)", ForceAxis::Ahead, 1.0, true},
    {Channel::Lat, "abs(V)", ForceAxis::Left, 1.0, false},
    {Channel::Lat, "abs(w)", ForceAxis::Left, 1.0, true},
    {Channel::Ang, "abs(V)", ForceAxis::Moment, 1.0, false},
    {Channel::Ang, "abs(w)", ForceAxis::Moment, 1.0, true},
    {Channel::Lon, "abs(V)*cos(yaw)", ForceAxis::WorldX, 1.0, false},
    {Channel::Lon, "abs(w)*cos(yaw)", ForceAxis::WorldX, 1.0, true},
    {Channel::Lon, "abs(V)*sin(yaw)", ForceAxis::WorldY, 1.0, false},
    {Channel::Lon, "abs(w)*sin(yaw)", ForceAxis::WorldY, 1.0, true},
    {Channel::Lat, "abs(V)*cos(yaw)", ForceAxis::WorldY, 1.0, false},
    {Channel::Lat, "abs(w)*cos(yaw)", ForceAxis::WorldY, 1.0, true},
    {Channel::Lat, "abs(V)*sin(yaw)", ForceAxis::WorldX, -1.0, false},
    {Channel::Lat, "abs(w)*sin(yaw)", ForceAxis::WorldX, -1.0, true},
}};

ForceFrame frame_of(ForceAxis axis) { return axis < ForceAxis::WorldX ? ForceFrame::Body : ForceFrame::World; }

}  // namespace

Basis with_force(const Basis& basis, ForceFrame frame) {
  std::array<std::vector<std::string>, kChannels> terms;
  for (const Known& known : kKnown) {
    if (frame_of(known.axis) == frame) {
      terms[static_cast<std::size_t>(known.channel)].emplace_back(known.text);
    }
  }
  const std::array<Basis, 2> both{basis, Basis("force", terms[0], terms[1], terms[2])};
  return union_basis(basis.name(), both);
}

std::vector<ForceTerm> force_terms(const Basis& basis) {
  std::vector<ForceTerm> found;
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const auto* known = std::ranges::find_if(kKnown, [&](const Known& each) {
      return each.channel == basis.channel(i) && each.text == basis.terms()[i].text();
    });
    if (known != kKnown.end()) {
      found.push_back({static_cast<Eigen::Index>(i), known->axis, known->sign, known->turning});
    }
  }
  return found;
}

}  // namespace slipwise
