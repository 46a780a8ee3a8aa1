// SPDX-License-Identifier: Apache-2.0
// A motion model for Nav2's MPPI controller: delay, limits, lags and slip that slipwise learned, in place of clamps.
#include <slipwise/planning/predict_columns.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <nav2_mppi_controller/motion_models.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "default_model.hpp"
#include "model_listener.hpp"

namespace slipwise_nav2 {

class LearnedMotionModel : public mppi::MotionModel {
 public:
  void initialize(mppi::ParametersHandler* handler, const std::string& name) override {
    auto get = handler->getParamGetter(name);
    std::string topic;
    get(threads_, "threads", 1);
    get(topic, "model_topic", std::string("/slipwise/motion_model"));
    drive_ = std::make_unique<Drive>(Drive{default_model()});
    std::string node = name + "_model";
    std::replace(node.begin(), node.end(), '.', '_');
    listener_ = std::make_unique<ModelListener>(node, topic, default_model());
  }

  /// Nav2 would sample sideways commands of a holonomic robot. Sideways slip is in `vy`, which it then does not add.
  bool isHolonomic() const override { return false; }

  /// Fills what the robot does over each period, the first included: commands in flight act before those of `state`.
  void predict(mppi::models::State& state) override {
    const auto period = static_cast<double>(model_dt_);
    listener_->take(drive_, period);
    const std::vector<slipwise::DriveCommand> sent = in_flight();
    slipwise::planning::predict_columns(drive_->at(period),
                                        {state.cvx.data(), state.cwz.data(), static_cast<std::size_t>(state.cvx.rows()),
                                         static_cast<std::size_t>(state.cvx.cols())},
                                        {.drive = {state.speed.linear.x, state.speed.angular.z}, .in_flight = sent},
                                        {state.vx.data(), state.vy.data(), state.wz.data()},
                                        {.threads = static_cast<unsigned>(std::max(threads_, 1))});
  }

 private:
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
  std::unique_ptr<Drive> drive_;
  std::unique_ptr<ModelListener> listener_;
};

}  // namespace slipwise_nav2

PLUGINLIB_EXPORT_CLASS(slipwise_nav2::LearnedMotionModel, mppi::MotionModel)
