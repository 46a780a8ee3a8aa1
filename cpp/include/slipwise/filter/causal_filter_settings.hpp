// SPDX-License-Identifier: Apache-2.0
// Settings of a causal filter: prior, update and noise.
#pragma once

#include "slipwise/filter/iekf.hpp"
#include "slipwise/filter/noise_scale.hpp"
#include "slipwise/filter/prior.hpp"

namespace slipwise {

struct CausalFilterSettings {
  PriorSettings prior = {};
  IekfSettings iekf = {};
  NoiseSettings noise = {};
};

}  // namespace slipwise
