// SPDX-License-Identifier: Apache-2.0
// Settings of a causal filter: prior, update and noise.
#pragma once

#include "slipwise/estimate/iekf.hpp"
#include "slipwise/estimate/noise_scale.hpp"
#include "slipwise/estimate/prior.hpp"

namespace slipwise {

struct CausalFilterSettings {
  PriorSettings prior = {};
  IekfSettings iekf = {};
  NoiseSettings noise = {};
};

}  // namespace slipwise
