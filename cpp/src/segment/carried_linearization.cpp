// SPDX-License-Identifier: Apache-2.0
// How far a segment bends away from its linearisation, against the noise of what measures it.
#include "slipwise/segment/carried_linearization.hpp"

#include <cmath>
#include <cstddef>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kStraight, 0.1);        // of the noise's standard deviation: as good as straight
SLIPWISE_TUNING(kStraightShift, 0.05);  // [ln s], [s]; over so little of a delay it bends by 1 mm at 1 m/s^2

/// Whether commands or poses come so much later or earlier that it shows in the second order alone.
bool shifted(const MotionModel& model, const Eigen::ArrayXd& drive) {
  const auto& places = model.actuator_places();
  for (Eigen::Index i = 0; i < drive.size(); ++i) {
    const auto place = places[static_cast<std::size_t>(i)];
    if (place >= kDelayV && place <= kClockOffset && !(drive[i] < kStraightShift)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::optional<SegmentLinearization> carried(const SegmentLinearization& at, const MotionModel& model,
                                            const Eigen::Ref<const Eigen::VectorXd>& step,
                                            const RowsCovariance& noise) {
  const auto drive = step.segment(model.slip_size(), model.actuator_size()).array().abs().eval();
  const auto by_drive = at.by_parameter.middleCols(model.slip_size(), model.actuator_size());
  const Rows moved = at.by_parameter * step;
  const Directions directions = at.path.directions();
  double turn = model.learned().sensor_extrinsics ? std::abs(step[step.size() - 1]) : 0.0;
  double across = 0.0;
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    (directions[i] == kTurn ? turn : across) += directions[i] == kTurn ? std::abs(moved[i]) : moved[i] * moved[i];
  }
  double reach = std::hypot(at.path.sensor().x, at.path.sensor().y);
  for (const Eigen::Vector3d& tangent : at.path.tangents) {
    reach += tangent.head<2>().norm();
  }
  Rows bent = 0.5 * by_drive.cwiseAbs() * drive.square().matrix();
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    bent[i] += directions[i] == kTurn ? 0.0 : turn * (0.5 * reach * turn + std::sqrt(across));
  }
  const bool seen = (directions.array() == Eigen::Index{kTurn}).any();  // without it, nothing says how far it turns
  if (!seen || !(bent.array() < kStraight * noise.diagonal().array().sqrt()).all() || shifted(model, drive)) {
    return std::nullopt;
  }
  SegmentLinearization there = at;
  there.predicted += moved;
  return there;
}

}  // namespace slipwise
