// SPDX-License-Identifier: Apache-2.0
// A motion model for Nav2's MPPI controller: delay, limits, lags and slip that slipwise learned, in place of clamps.
#include <slipwise/planning/predict_columns.hpp>

#include <algorithm>
#include <cstddef>
#include <nav2_mppi_controller/motion_models.hpp>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "model.h"  // slipwise export model.yaml --to c-header -o model.h

namespace slipwise_nav2 {

class LearnedMotionModel : public mppi::MotionModel {
 public:
  void initialize(mppi::ParametersHandler* handler, const std::string& name) override {
    auto get = handler->getParamGetter(name);
    get(threads_, "threads", 1);
  }

  /// Nav2 would sample sideways commands of a holonomic robot. Sideways slip is in `vy`, which it then does not add.
  bool isHolonomic() const override { return false; }

  /// Fills what the robot does over each period, the first included: commands in flight act before those of `state`.
  void predict(mppi::models::State& state) override {
    if (!program_ || program_->setting().period != static_cast<double>(model_dt_)) {
      program_.emplace(compiled(static_cast<double>(model_dt_)));
    }
    const std::vector<slipwise::DriveCommand> sent = in_flight();
    slipwise::planning::predict_columns(*program_,
                                        {state.cvx.data(), state.cwz.data(), static_cast<std::size_t>(state.cvx.rows()),
                                         static_cast<std::size_t>(state.cvx.cols())},
                                        {.drive = {state.speed.linear.x, state.speed.angular.z}, .in_flight = sent},
                                        {state.vx.data(), state.vy.data(), state.wz.data()},
                                        {.threads = static_cast<unsigned>(std::max(threads_, 1))});
  }

 private:
  static slipwise::RolloutProgram compiled(double period) {
    const std::vector<std::string> lon{SLIPWISE_TERMS_LON}, lat{SLIPWISE_TERMS_LAT}, ang{SLIPWISE_TERMS_ANG};
    const slipwise::MotionModel model({"learned", lon, lat, ang}, {.dynamics = SLIPWISE_HAS_DYNAMICS,
                                                                   .response = SLIPWISE_HAS_RESPONSE,
                                                                   .delays = SLIPWISE_HAS_DELAYS,
                                                                   .wheelbase = SLIPWISE_WHEELBASE});
    const std::vector<double> values{SLIPWISE_PARAMETERS};
    const slipwise::CommandLimits limits{.speed = {SLIPWISE_LIMITS_SPEED},
                                         .yaw_rate = {SLIPWISE_LIMITS_YAW_RATE},
                                         .side = {SLIPWISE_LIMITS_SIDE},
                                         .wheel_separation = SLIPWISE_LIMITS_WHEEL_SEPARATION,
                                         .gain_v = SLIPWISE_LIMITS_GAIN_V,
                                         .gain_omega = SLIPWISE_LIMITS_GAIN_OMEGA};
    return {
        model, Eigen::Map<const Eigen::VectorXd>(values.data(), model.size()), {.period = period, .limits = limits}};
  }

  /// What Nav2 published before, the oldest first. Its histories are as long as `model_delay_vx` and `_wz` say.
  std::vector<slipwise::DriveCommand> in_flight() const {
    const std::size_t count = std::max(cmd_history_vx_.size(), cmd_history_wz_.size());
    const auto sent = [count](const std::vector<float>& history, std::size_t i) {
      const std::size_t missing = count - history.size();  // of the shorter one the oldest goes on
      return history.empty() ? 0.0 : static_cast<double>(history[i < missing ? 0 : i - missing]);
    };
    std::vector<slipwise::DriveCommand> commands;
    for (std::size_t i = 0; i < count; ++i) {
      commands.push_back({sent(cmd_history_vx_, i), sent(cmd_history_wz_, i)});
    }
    return commands;
  }

  int threads_ = 1;
  std::optional<slipwise::RolloutProgram> program_;
};

}  // namespace slipwise_nav2

PLUGINLIB_EXPORT_CLASS(slipwise_nav2::LearnedMotionModel, mppi::MotionModel)
