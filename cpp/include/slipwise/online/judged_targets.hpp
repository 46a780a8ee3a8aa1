// SPDX-License-Identifier: Apache-2.0
// What was predicted and judged of late, kept so that a model that is handed on can be held against it too.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/online/shared_list.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// The last segments of each horizon that were predicted before they were learned. Copies share them.
class JudgedTargets {
 public:
  static constexpr std::size_t kMost = 60;
  using Poses = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

  explicit JudgedTargets(std::size_t horizons = 0) : kept_(horizons) {}

  /// Keeps a segment of a horizon; the oldest goes where there are more than `kMost`.
  void keep(std::size_t horizon, DrivenSegment driven);
  /// Poses x, y [m], yaw [rad] at the ends of the segments of a horizon, oldest first, [N, 3]: as `known` predicts them
  /// of a drive with these limits.
  /// \throws std::out_of_range when there is no such horizon.
  Poses predicted_by(const MotionPosterior& known, const CommandLimits& limits, std::size_t horizon) const;
  /// \throws std::invalid_argument where a loaded one is of other horizons.
  void check_loaded(const JudgedTargets& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.kept_);
  }

 private:
  std::vector<SharedList<DrivenSegment, kMost>> kept_;  ///< of each horizon
};

}  // namespace slipwise
