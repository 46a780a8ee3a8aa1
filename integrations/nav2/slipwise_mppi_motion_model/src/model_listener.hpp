// SPDX-License-Identifier: Apache-2.0
// Listens to the model that slipwise learns, on a node and a thread of its own, and hands it on without a lock.
#pragma once

#include <slipwise/motion/model_file.hpp>
#include <slipwise/rollout/handoff.hpp>
#include <slipwise/rollout/rollout_program.hpp>

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <slipwise_msgs/msg/motion_model.hpp>
#include <string>
#include <thread>
#include <utility>

namespace slipwise_nav2 {

/// A model, and its program for a control period.
struct Drive {
  slipwise::RolloutModel model;
  std::optional<slipwise::RolloutProgram> program = std::nullopt;

  const slipwise::RolloutProgram& at(double period) {
    if (!program || program->setting().period != period) {
      program.emplace(model.motion, model.parameters,
                      slipwise::RolloutSetting{.period = period, .limits = model.limits});
    }
    return *program;
  }
};

/// Where the newest model is not valid, cannot be used, or nobody publishes one any more, the default model takes its
/// place, and the log says once why.
class ModelListener {
 public:
  using Message = slipwise_msgs::msg::MotionModel;

  ModelListener(const std::string& name, const std::string& topic, slipwise::RolloutModel by_default)
      : topic_(topic), default_(std::move(by_default)), node_(std::make_shared<rclcpp::Node>(name)) {
    subscription_ = node_->create_subscription<Message>(topic, rclcpp::QoS(1).reliable().transient_local(),
                                                        [this](const Message& message) { hear(message); });
    executor_.add_node(node_);
    thread_ = std::thread([this] { listen(); });
  }
  ModelListener(const ModelListener&) = delete;
  ModelListener& operator=(const ModelListener&) = delete;
  ~ModelListener() {
    stopped_ = true;
    thread_.join();
  }

  /// For the control loop: puts the newest drive in place of `current`, where there is a newer one.
  bool take(std::unique_ptr<Drive>& current, double period) {
    period_.store(period, std::memory_order_relaxed);
    return handoff_.take(current);
  }

 private:
  static constexpr std::chrono::milliseconds kLook{200};
  static constexpr int kAway = 25;  // looks without a publisher, after which it is gone

  void listen() {
    for (int away = 0; !stopped_ && rclcpp::ok();) {
      executor_.spin_once(kLook);
      away = subscription_->get_publisher_count() > 0 ? 0 : away + 1;
      if (away == kAway) {
        use_default("nobody publishes it");
      }
    }
  }

  void hear(const Message& message) {
    if (message.validity != Message::ESTIMATED) {
      use_default("the model is not valid");
      return;
    }
    if (message.input != "command") {
      use_default("the model takes wheel speeds, and a controller gives commands");
      return;
    }
    try {
      hand_on(slipwise::ModelFile::of(message).model());
      why_.clear();
    } catch (const std::exception& problem) {
      use_default(problem.what());
    }
  }

  /// Compiles it here, and not in the control loop.
  void hand_on(slipwise::RolloutModel model) {
    auto drive = std::make_unique<Drive>(Drive{std::move(model)});
    if (const double period = period_.load(std::memory_order_relaxed); period > 0.0) {
      drive->at(period);
    }
    handoff_.put(std::move(drive));
  }

  void use_default(const std::string& why) {
    if (why_ == why) {
      return;
    }
    why_ = why;
    RCLCPP_WARN(node_->get_logger(), "%s: %s; the default model takes its place", topic_.c_str(), why.c_str());
    hand_on(default_);
  }

  std::string topic_, why_;
  slipwise::RolloutModel default_;
  slipwise::Handoff<Drive> handoff_;
  std::atomic<double> period_ = 0.0;
  std::atomic<bool> stopped_ = false;
  std::shared_ptr<rclcpp::Node> node_;
  rclcpp::Subscription<Message>::SharedPtr subscription_;
  rclcpp::executors::SingleThreadedExecutor executor_;
  std::thread thread_;
};

}  // namespace slipwise_nav2
