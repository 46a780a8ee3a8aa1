// SPDX-License-Identifier: Apache-2.0
// Gives the plug-in a thousand models while it predicts, then ones that must not be used; fails where it drives
// another.
#include <cmath>
#include <cstdlib>

#include "learned_motion_model.cpp"

namespace {

using Message = slipwise_msgs::msg::MotionModel;
constexpr int kModels = 1000;
constexpr double kStep = 1e-4;  // of the slip between two models

void require(bool right, const char* what) {
  if (!right) {
    std::fprintf(stderr, "failed: %s\n", what);
    std::exit(1);
  }
}

Message model_with(double slip) {
  Message message;
  message.input = "command";
  message.validity = Message::ESTIMATED;
  message.basis = "test";
  message.lon = {"V"};
  message.parameters.resize(1);
  message.parameters[0].name = "lon.V";
  message.parameters[0].stage = "slip";
  message.parameters[0].value = slip;
  message.covariance = {1e-6};
  return message;
}

class Controller {
 public:
  Controller() {
    plugin_.initialize(&parameters_, "FollowPath.learned");
    plugin_.setDelays(0.05F, 0.0F, 0.0F);
    for (Eigen::ArrayXXf* each : {&state_.vx, &state_.vy, &state_.wz, &state_.cvx, &state_.cvy, &state_.cwz}) {
      each->setZero(4, 4);
    }
    state_.cvx = 1.0F;
  }
  /// Which model drives: slip is the fraction that the robot is slower.
  double slip() {
    static_cast<mppi::MotionModel&>(plugin_).predict(state_);
    const float slowest = state_.vx.minCoeff();
    require(state_.vx.maxCoeff() - slowest < 1e-6F, "one model drives all samples");
    return static_cast<double>(slowest) - 1.0;
  }
  /// The slip once all messages were heard.
  double slip_after(int messages) {
    while (rclcpp::Other::one().delivered < messages) {
      slip();
    }
    return slip();
  }

 private:
  mppi::ParametersHandler parameters_;
  PluginOfTest plugin_;
  mppi::models::State state_;
};

bool near(double a, double b) { return std::abs(a - b) < 1e-6; }

/// Publishes models from the one after `first` on while the plug-in predicts; returns how many were driven.
/// Patient, the publisher waits until each one is.
int driven(Controller& controller, int first, bool patient) {
  const int last = first + kModels;
  std::atomic<double> now = -kStep * first;
  std::thread publisher([&now, first, last, patient] {
    for (int i = first + 1; i <= last; ++i) {
      rclcpp::Other::one().publish(model_with(-kStep * i));
      while (patient && !near(now, -kStep * i)) {
        std::this_thread::yield();
      }
    }
  });
  int exchanges = 0;
  while (!near(now, -kStep * last)) {
    const double slip = controller.slip();
    require(slip < now + 1e-6, "models come in their order");
    exchanges += slip < now - 1e-6 ? 1 : 0;
    now = slip;
  }
  publisher.join();
  return exchanges;
}

}  // namespace

int main() {
  rclcpp::Other& other = rclcpp::Other::one();
  Controller controller;
  require(near(controller.slip(), 0.0), "the default model has no slip");
  const int hurried = driven(controller, 0, false);
  require(hurried > 0, "a model is driven");
  require(driven(controller, kModels, true) == kModels, "every model is driven where none comes before that");
  require(other.warnings == 0, "nothing is said of valid models");

  Message invalid = model_with(-0.2), broken = model_with(-0.2), of_wheels = model_with(-0.2);
  invalid.validity = Message::INVALID;
  broken.covariance.clear();
  of_wheels.input = "wheel";
  int heard = 2 * kModels, said = 0;
  for (const Message& bad : {invalid, broken, of_wheels}) {
    for (int times = 0; times < 3; ++times) {
      other.publish(bad);
    }
    require(near(controller.slip_after(heard += 3), 0.0), "the default model takes the place of a bad one");
    require(other.warnings == ++said, "why is said once");
    other.publish(model_with(-0.1));
    require(near(controller.slip_after(++heard), -0.1), "a valid model is used again");
  }
  other.publishers = 0;
  while (other.warnings == said) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  require(near(controller.slip(), 0.0), "the default model takes the place of one that nobody stands for");
  std::printf("%d of %d and %d of %d models were driven\n", hurried, kModels, kModels, kModels);
  return 0;
}
