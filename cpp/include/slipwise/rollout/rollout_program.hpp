// SPDX-License-Identifier: Apache-2.0
// A motion model compiled for rollouts of one control period: made once, used for any number of batches.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/rollout/actuator_schedule.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/slip_program.hpp"
#include "slipwise/slip/slip_ahead.hpp"

namespace slipwise {

/// What stays the same over all rollouts.
struct RolloutSetting {
  double period;              ///< time that each command is held [s]
  double gx = 0.0;            ///< gravity along the robot's x axis, positive downhill [m/s^2]
  double gy = 0.0;            ///< along its y axis [m/s^2]
  CommandLimits limits = {};  ///< of the drive, in front of its delay and lag
  double rise_x = 0.0;        ///< of a plane per metre along the axes of the starts' frame; excludes gx and gy
  double rise_y = 0.0;        ///< [m/m]
  SlipAhead ahead = {};       ///< where slip becomes another along the path
  bool sideways = false;      ///< the robot is commanded sideways too, as (v, vy, omega)

  bool on_grade() const { return rise_x != 0.0 || rise_y != 0.0; }
};

/// The program in the numbers of a kernel.
template <typename Scalar>
struct LaneConstants {
  std::vector<LanePart<Scalar>> parts;  ///< lead-in, cycle, tail
  std::vector<Scalar> coefficients;
  DriveRamps<Scalar> limits;
};

/// What the two lags of a channel do over a part, with their gains. `T` is a number, or one with derivatives.
template <typename T>
LaneLag<T> lane_lag(const ChannelFractionOf<T>& part, const AxisResponseOf<T>& response) {
  const T fast = response.fast_fraction();
  const T slow = response.gain - fast;
  return {.mean_by_input = fast * (1.0 - part.fast.mean_gap) + slow * (1.0 - part.slow.mean_gap),
          .mean_by_fast = part.fast.mean_gap,
          .mean_by_slow = part.slow.mean_gap,
          .fast_by_input = fast * (1.0 - part.fast.end_gap),
          .fast_by_fast = part.fast.end_gap,
          .slow_by_input = slow * (1.0 - part.slow.end_gap),
          .slow_by_slow = part.slow.end_gap};
}

/// What a change of the slip parameters adds to a program: the same products; the drive itself does not change.
SlipProgram slip_change(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& change,
                        const RolloutSetting& setting);

class RolloutProgram {
 public:
  /// \throws std::invalid_argument when the parameters or the slip ahead do not fit the model, the period is not
  /// positive, the gravity
  /// not finite, a limit is none, the plane steeper than 60
  /// degrees, or the basis too large.
  RolloutProgram(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                 const RolloutSetting& setting);

  const RolloutSetting& setting() const { return setting_; }
  const SlipProgram& slip() const { return slip_; }
  /// Its period is one piece of a control period.
  const ActuatorSchedule& actuator() const { return actuator_; }
  bool limited() const { return !unlimited(setting_.limits); }
  /// Whether commands have a sideways speed: the setting says so, or slip depends on it.
  bool sideways() const { return setting_.sideways; }
  /// Into how many pieces a command is cut, since the drive ramps; 1 where it does not.
  std::size_t pieces() const { return pieces_; }

  const std::optional<LaneQuadratic>& quadratic() const { return quadratic_; }
  const std::vector<LaneProduct>& products() const { return products_; }
  template <typename Scalar>
  const LaneConstants<Scalar>& constants() const;

 private:
  RolloutSetting setting_;
  SlipProgram slip_;
  std::vector<SlipProgram> changes_;  ///< of the slip at each edge ahead: the same products
  std::size_t pieces_;
  ActuatorSchedule actuator_;
  std::optional<LaneQuadratic> quadratic_;
  std::vector<LaneProduct> products_;
  LaneConstants<float> float_;
  LaneConstants<double> double_;
};

template <>
inline const LaneConstants<float>& RolloutProgram::constants<float>() const {
  return float_;
}
template <>
inline const LaneConstants<double>& RolloutProgram::constants<double>() const {
  return double_;
}

}  // namespace slipwise
