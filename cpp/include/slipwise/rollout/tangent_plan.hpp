// SPDX-License-Identifier: Apache-2.0
// What the poses of rollouts are differentiated by, as the kernel of tangents takes it: parameters that are not known,
// slip ahead that is not, and how uncertain they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slipwise/rollout/lane_tangent_job.hpp"
#include "slipwise/rollout/path_noise.hpp"
#include "slipwise/rollout/rollout_program.hpp"

namespace slipwise {

/// Float and double.
template <typename Scalar>
class TangentPlan {
 public:
  /// For rollouts of so many periods; their covariances grow by one factor for each, or by none.
  TangentPlan(const UncertainModel& model, std::size_t periods, std::span<const double> growth);

  /// The model, with commands that act on the boundary of a period moved off it by a millionth: there the path has a
  /// derivative by the delay.
  const RolloutProgram& program() const { return program_; }
  const ActuatorScheduleOf<ActuatorDual>& actuator() const { return actuator_; }
  /// Which of the model's actuator parameters the first columns are.
  std::span<const int> actuator_places() const { return actuator_places_; }

  /// The numbers of a kernel, without where the start's derivatives, its state and its results are.
  LaneTangents<Scalar> lanes() const;

 private:
  void add_actuator(const UncertainModel& model);
  void add_slip(const UncertainModel& model);
  void add_column(const MotionModel& model, Eigen::Index parameter, const Eigen::MatrixXd& by_stretch);
  void add_factor(const Eigen::MatrixXd& covariance);
  void add_disturbance(const UncertainModel& model, std::size_t periods);

  /// One column of slip: what it is, and how it changes the program.
  struct Column {
    Eigen::Index parameter;  ///< or kAhead
    std::vector<TangentEntry<Scalar>> entries;
    bool turns;
  };
  static constexpr Eigen::Index kAhead = -1;

  RolloutProgram program_;
  ActuatorScheduleOf<ActuatorDual> actuator_;
  std::vector<int> actuator_places_;
  std::vector<PartTangent<Scalar>> parts_;
  std::vector<std::uint8_t> moved_;
  std::vector<Column> columns_;  ///< of slip
  std::size_t turning_ = 0;
  std::vector<std::size_t> first_entry_, disturbed_;
  std::vector<TangentEntry<Scalar>> entries_;
  std::vector<Scalar> factor_, disturbance_, inflation_;
  MotionNoise noise_;
  Eigen::Vector3d root_;
};

}  // namespace slipwise
