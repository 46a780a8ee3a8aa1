// SPDX-License-Identifier: Apache-2.0
// Poses of all sources but the first: in the order of their stamps, gated, and cut into segments.
#pragma once

#include <optional>
#include <vector>

#include "slipwise/online/measured_drive.hpp"
#include "slipwise/online/pose_source.hpp"
#include "slipwise/online/stream_output.hpp"
#include "slipwise/online/stream_settings.hpp"

namespace slipwise {

/// A pose is used `kClocksApart` after its stamp, so that inputs are known whenever it really was.
class PoseSources {
 public:
  /// Those of the settings behind the first.
  explicit PoseSources(const StreamSettings& settings);

  /// Another run begins.
  void start_run();
  /// Takes a pose that is not older than `oldest` [s]: its stamp without what is known of its clock, minus infinity
  /// where nothing is to be learned from it, none where it is rejected.
  std::optional<double> push(MeasuredPose pose, double oldest, StreamOutput& out);
  /// Uses what cannot be preceded any more before `until` [s], the earliest first.
  void advance(double until, const MeasuredDrive& drive, StreamOutput& out);
  /// No pose of this run follows; the gates first, then segments that are complete by `now` [s].
  void finish_gates(const MeasuredDrive& drive, StreamOutput& out);
  void finish_segments(double now, const MeasuredDrive& drive, StreamOutput& out);
  /// From when on inputs are needed [s], where nothing else needs them from before `begun` on.
  double begins(double begun) const;

  /// \throws std::invalid_argument where loaded ones are none that `made`, of the same settings, could have become.
  void check_loaded(const PoseSources& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.sources_);
  }

 private:
  static void process(PoseSource& source, const GatedPoses& gated, double known_at, const MeasuredDrive& drive,
                      StreamOutput& out);

  std::vector<PoseSource> sources_;
};

}  // namespace slipwise
