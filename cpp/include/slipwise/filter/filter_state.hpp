// SPDX-License-Identifier: Apache-2.0
// What a causal filter has learned of one model: its posterior, the size of the noise, and how scores scatter.
#pragma once

#include "slipwise/filter/iekf.hpp"
#include "slipwise/filter/noise_scale.hpp"
#include "slipwise/filter/score_covariance.hpp"

namespace slipwise {

/// R of a measured segment by the shape of the noise alone, and as large as it was learned to be.
struct SegmentNoise {
  RowsCovariance expected;
  RowsCovariance scaled;
};

struct FilterState {
  Estimate estimate;
  NoiseScale noise_scale;
  ScoreCovariance scores;

  FilterState() = default;
  FilterState(const MotionModel& model, const NoiseSettings& noise);

  /// Learns one segment.
  IekfUpdate learn(const MotionModel& model, const InputHistory& inputs, const Segment& segment,
                   const NoiseSettings& noise, const IekfSettings& iekf);

  /// Goes on from an update: it also teaches how large noise is, and how scores scatter.
  void take(const IekfUpdate& update, const Segment& segment, const SegmentNoise& noise);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.estimate, self.noise_scale, self.scores);
  }
};

}  // namespace slipwise
