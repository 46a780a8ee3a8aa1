// SPDX-License-Identifier: Apache-2.0
// Off-line smoothing of slowly varying parameters: forward IEKF, backward Rauch-Tung-Striebel pass.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "slipwise/filter/batch.hpp"
#include "slipwise/filter/iekf.hpp"

namespace slipwise {

/// How parameters may change, per distance driven: a parked robot forgets nothing.
/// RandomWalk: variance grows by the prior's over each `length`. MeanReverting: drawn back to the prior, a =
/// exp(-ds/length).
enum class Drift : std::uint8_t { RandomWalk, MeanReverting };

struct DriftSettings {
  Drift drift = Drift::MeanReverting;
  double length = 100.0;  ///< [m], of wheel travel |v| + kTurnRadius |omega|
};

/// What the drift does over a distance: p <- p0 + a (p - p0), P <- a^2 P + added.
Estimate drifted(const Estimate& estimate, const Estimate& prior, double distance, const DriftSettings& settings);

/// The parameters during each segment, given all segments; `data` in order of time.
/// \throws std::invalid_argument when sizes do not fit, there is no datum, or the length is not positive.
std::vector<Estimate> rts_smooth(const MotionModel& model, const Estimate& prior, std::span<const BatchDatum> data,
                                 const DriftSettings& drift = {}, const IekfSettings& iekf = {});

}  // namespace slipwise
