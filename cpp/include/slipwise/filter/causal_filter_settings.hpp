// SPDX-License-Identifier: Apache-2.0
// Settings of a causal filter: prior, update, noise, and a force that acts on the robot.
#pragma once

#include "slipwise/filter/body_force.hpp"
#include "slipwise/filter/iekf.hpp"
#include "slipwise/filter/noise_scale.hpp"
#include "slipwise/filter/prior.hpp"

namespace slipwise {

/// Slip that may jump (`BranchBank`).
struct BranchSettings {
  bool follow = true;
};

struct CausalFilterSettings {
  PriorSettings prior = {};
  IekfSettings iekf = {};
  NoiseSettings noise = {};
  BodyForceSettings force = {};
  BranchSettings branches = {};
};

}  // namespace slipwise
