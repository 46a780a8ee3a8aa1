// SPDX-License-Identifier: Apache-2.0
// What a model file, or a message MotionModel of the ROS package slipwise_msgs, says of the motion, and the model of
// it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise {

/// A learned model of base_link, by the clock of its inputs, as rollouts take it.
struct RolloutModel {
  MotionModel motion;
  Eigen::VectorXd parameters;
  Eigen::MatrixXd covariance;  ///< of the parameters
  CommandLimits limits;        ///< of the drive, in front of its delay and lag
};

struct ModelFile {
  /// One learned number.
  struct Row {
    std::string name;
    std::string stage;  ///< slip, force, actuator, clock, sensor, limits or car
    double value = 0.0;
  };

  std::string input;  ///< "command" or "wheel": what the model takes
  bool good = false;  ///< whether it may be used
  std::string basis;
  std::vector<std::string> lon, lat, ang;  ///< slip terms
  ActuatorParameters learned;
  std::vector<double> limit_gains;  ///< of speed and yaw rate behind the limits; empty: there are none
  std::vector<Row> rows;
  std::vector<double> covariance;  ///< of all rows, row by row

  /// Reads the text of a model file. Only in slipwise::yaml, which the CMake option SLIPWISE_YAML builds.
  /// \throws std::invalid_argument when it is no such text.
  static ModelFile parse(const std::string& text);

  /// Reads slipwise_msgs::msg::MotionModel, or any struct with its fields.
  template <typename Message>
  static ModelFile of(const Message& message) {
    ModelFile file;
    file.input = message.input;
    file.good = message.validity == Message::ESTIMATED;
    file.basis = message.basis;
    file.lon.assign(message.lon.begin(), message.lon.end());
    file.lat.assign(message.lat.begin(), message.lat.end());
    file.ang.assign(message.ang.begin(), message.ang.end());
    file.learned = {.dynamics = message.dynamics,
                    .clock_offset = message.clock_offset,
                    .response = message.response,
                    .sensor_extrinsics = message.sensor_extrinsics,
                    .delays = message.delays,
                    .lags = message.lags,
                    .wheelbase = message.wheelbase};
    file.limit_gains.assign(message.limit_gains.begin(), message.limit_gains.end());
    for (const auto& row : message.parameters) {
      file.rows.push_back({row.name, row.stage, row.value});
    }
    file.covariance.assign(message.covariance.begin(), message.covariance.end());
    return file;
  }

  /// \throws std::invalid_argument when parts contradict each other, a term or a limit is not known, or the model takes
  /// throttle and steering, or pushes the robot by its heading over the map: rollouts know neither.
  RolloutModel model() const;
};

}  // namespace slipwise
