// SPDX-License-Identifier: Apache-2.0
// Segments that were judged are predicted again.
#include "slipwise/online/judged_targets.hpp"

#include <memory>
#include <utility>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/online/behind_limits.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

void JudgedTargets::keep(std::size_t horizon, DrivenSegment driven) {
  kept_.at(horizon).keep(std::make_shared<const DrivenSegment>(std::move(driven)));
}

JudgedTargets::Poses JudgedTargets::predicted_by(const MotionPosterior& known, const CommandLimits& limits,
                                                 std::size_t horizon) const {
  const auto& kept = kept_.at(horizon);
  Poses poses(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const DrivenSegment driven = behind(kept[i], limits);
    const SegmentPath path = integrate_segment(known.model, known.estimate.mean, driven.inputs, driven.segment);
    poses.row(static_cast<Eigen::Index>(i)) = chart_of(path.directions(), path.rows());
  }
  return poses;
}

void JudgedTargets::check_loaded(const JudgedTargets& made) const {
  archive::require(kept_.size() == made.kept_.size(), "segments that were judged are of other horizons");
}

}  // namespace slipwise
