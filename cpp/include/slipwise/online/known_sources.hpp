// SPDX-License-Identifier: Apache-2.0
// Estimates of several pose sources, and the way of their segments.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slipwise/filter/causal_filter_settings.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/online/segment_stream.hpp"
#include "slipwise/online/source_calibration.hpp"
#include "slipwise/online/source_merge.hpp"
#include "slipwise/online/source_noise.hpp"

namespace slipwise {

/// A segment to be predicted, with errors as large as those of the poses that measure it are known to be; `scale` is
/// the size of noise that the predicting model has learned.
DrivenSegment measured_by(const SourceNoise& noise, const TargetSegment& target, const Eigen::Vector3d& scale);

class KnownSources {
 public:
  KnownSources() = default;
  KnownSources(const StreamSettings& stream, const CausalFilterSettings& filter);

  /// Learns what a segment says of its source under the estimated motion; returns what is to be learned now.
  /// `poor` tells whether its errors are too large.
  struct Found {
    std::vector<DrivenSegment> learned;
    bool poor = false;
  };
  Found see(const MotionPosterior& posterior, SourceSegment item);
  /// The rest of a run.
  std::vector<DrivenSegment> finish() { return counted(merge_.finish()); }
  void start_run();
  /// Segments of the first source that wait.
  std::vector<DrivenSegment> waiting() const;
  const SourceNoise& noise() const { return noise_; }
  /// Of each source; the first is not calibrated here.
  const std::vector<SourceCalibration>& calibrations() const { return calibrations_; }
  /// Segments learned of each.
  const std::vector<std::size_t>& learned() const { return learned_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const KnownSources& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.filter_, self.calibrations_, self.noise_, self.merge_, self.seen_until_, self.learned_);
  }

 private:
  void look(const MotionPosterior& posterior, const DrivenSegment& driven, const SourceSegment& item);
  bool calibrated(const MotionPosterior& posterior, DrivenSegment& driven, const SourceSegment& item) const;
  std::vector<DrivenSegment> counted(std::vector<DrivenSegment> learned);

  std::vector<SourceSettings> settings_;
  CausalFilterSettings filter_;
  std::vector<SourceCalibration> calibrations_;
  SourceNoise noise_;
  SourceMerge merge_;
  std::vector<double> seen_until_;  ///< of each source: end of the last segment that it was learned from [s]
  std::vector<std::size_t> learned_;
};

}  // namespace slipwise
