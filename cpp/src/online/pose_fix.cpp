// SPDX-License-Identifier: Apache-2.0
// The fixes by name.
#include "slipwise/online/pose_fix.hpp"

#include <array>

namespace slipwise {
namespace {

constexpr std::array<std::string_view, kPoseFixes> kNames{
    "", "none", "estimated", "single", "differential", "rtk_float", "rtk_fixed"};

}  // namespace

std::string_view fix_name(PoseFix fix) { return kNames[static_cast<std::size_t>(fix)]; }

}  // namespace slipwise
