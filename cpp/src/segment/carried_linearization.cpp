// SPDX-License-Identifier: Apache-2.0
// How far a segment bends away from its linearisation, against the noise of what measures it.
#include "slipwise/segment/carried_linearization.hpp"

#include <cmath>
#include <cstddef>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr Eigen::Index kDelay = 2;  // places among the parameters of an actuator: two delays, and the clock offset
constexpr Eigen::Index kClockOffset = 4;
SLIPWISE_TUNING(kStraight, 0.1);        // of the noise's standard deviation: as good as straight
SLIPWISE_TUNING(kStraightShift, 0.05);  // [ln s], [s]; over so little of a delay it bends by 1 mm at 1 m/s^2

/// Whether commands or poses come so much later or earlier that it shows in the second order alone.
bool shifted(const MotionModel& model, const Eigen::ArrayXd& drive) {
  const auto& places = model.actuator_places();
  for (Eigen::Index i = 0; i < drive.size(); ++i) {
    const auto place = places[static_cast<std::size_t>(i)];
    if (place >= kDelay && place <= kClockOffset && !(drive[i] < kStraightShift)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::optional<SegmentLinearization> carried(const SegmentLinearization& at, const MotionModel& model,
                                            const Eigen::Ref<const Eigen::VectorXd>& step,
                                            const Eigen::Matrix3d& noise) {
  const auto drive = step.segment(model.slip_size(), model.actuator_size()).array().abs().eval();
  const auto by_drive = at.by_parameter.middleCols(model.slip_size(), model.actuator_size());
  const Eigen::Vector3d moved = at.by_parameter * step;
  const double turn = std::abs(moved.z()) + (model.learned().sensor_extrinsics ? std::abs(step[step.size() - 1]) : 0.0);
  double reach = std::hypot(at.path.sensor.x, at.path.sensor.y);
  for (const Eigen::Vector3d& tangent : at.path.tangents) {
    reach += tangent.head<2>().norm();
  }
  Eigen::Vector3d bent = 0.5 * by_drive.cwiseAbs() * drive.square().matrix();
  bent.head<2>().array() += turn * (0.5 * reach * turn + moved.head<2>().norm());
  if (!(bent.array() < kStraight * noise.diagonal().array().sqrt()).all() || shifted(model, drive)) {
    return std::nullopt;
  }
  SegmentLinearization there = at;
  there.predicted = {at.predicted.x + moved.x(), at.predicted.y + moved.y(), at.predicted.theta + moved.z()};
  return there;
}

}  // namespace slipwise
