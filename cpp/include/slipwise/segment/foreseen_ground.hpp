// SPDX-License-Identifier: Apache-2.0
// The ground ahead as known when a segment begins: a prediction uses nothing that is measured later.
#pragma once

#include <memory>

#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// The plane on which the first measured attitude stands, for an attitude measured along a segment; a plane and a map
/// are known before. Nothing of level ground.
inline std::shared_ptr<const Ground> foreseen_ground(const std::shared_ptr<const Ground>& ground) {
  const auto* measured = ground ? std::get_if<MeasuredTilts>(ground.get()) : nullptr;
  if (measured == nullptr) {
    return ground;
  }
  return measured->at.empty() ? nullptr : std::make_shared<const Ground>(grade_of(measured->at.front()));
}

}  // namespace slipwise
