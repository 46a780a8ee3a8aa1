// SPDX-License-Identifier: Apache-2.0
// A stand-in of our own for what the plug-in sees of Nav2's MPPI controller: names and types, no behaviour.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace geometry_msgs::msg {
struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Twist {
  Vector3 linear, angular;
};
}  // namespace geometry_msgs::msg

namespace mppi {

class ParametersHandler {
 public:
  auto getParamGetter(const std::string& /*name*/) {
    return [](auto& setting, const std::string& /*key*/, auto by_default) { setting = by_default; };
  }
};

namespace models {
struct State {
  Eigen::ArrayXXf vx, vy, wz, cvx, cvy, cwz;
  geometry_msgs::msg::Twist speed;
};
}  // namespace models

class MotionModel {
 public:
  virtual ~MotionModel() = default;
  virtual void initialize(ParametersHandler*, const std::string&) {}
  virtual void predict(models::State&) {}
  virtual bool isHolonomic() const = 0;
  void setDelays(float model_dt, float model_delay_vx, float model_delay_wz) {
    model_dt_ = model_dt;
    cmd_history_vx_.resize(static_cast<std::size_t>(std::floor(model_delay_vx / model_dt + 0.5F)), 0.0F);
    cmd_history_wz_.resize(static_cast<std::size_t>(std::floor(model_delay_wz / model_dt + 0.5F)), 0.0F);
  }
  void pushCommandHistory(float vx, float wz) {
    for (auto [history, value] : {std::pair{&cmd_history_vx_, vx}, std::pair{&cmd_history_wz_, wz}}) {
      if (!history->empty()) {
        history->erase(history->begin());
        history->push_back(value);
      }
    }
  }

 protected:
  float model_dt_ = 0.0F;
  std::vector<float> cmd_history_vx_, cmd_history_wz_;
};

}  // namespace mppi
