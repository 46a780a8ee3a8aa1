// SPDX-License-Identifier: Apache-2.0
// A stand-in of our own for what the plug-in sees of rclcpp: one topic in one process, whose messages a test puts.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdio>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace rclcpp {

/// What the test plays: the other side of the topic.
struct Other {
  std::mutex mutex;
  std::deque<std::function<void()>> waiting;                       // deliveries
  std::function<std::function<void()>(const void*)> with_message;  // makes one of a message
  std::atomic<std::size_t> publishers = 1;
  std::atomic<int> warnings = 0;
  std::atomic<int> delivered = 0;

  static Other& one() {
    static Other other;
    return other;
  }
  template <typename Message>
  void publish(const Message& message) {
    const std::lock_guard<std::mutex> lock(mutex);
    waiting.push_back(with_message(&message));
  }
};

inline bool ok() { return true; }

class QoS {
 public:
  explicit QoS(int) {}
  QoS& reliable() { return *this; }
  QoS& transient_local() { return *this; }
};

struct Logger {};

template <typename Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
  std::size_t get_publisher_count() const { return Other::one().publishers; }
};

class Node {
 public:
  explicit Node(const std::string&) {}
  Logger get_logger() const { return {}; }
  template <typename Message, typename Callback>
  std::shared_ptr<Subscription<Message>> create_subscription(const std::string&, const QoS&, Callback callback) {
    Other::one().with_message = [callback](const void* message) {
      return [callback, kept = *static_cast<const Message*>(message)] { callback(kept); };
    };
    return std::make_shared<Subscription<Message>>();
  }
};

namespace executors {
class SingleThreadedExecutor {
 public:
  void add_node(const std::shared_ptr<Node>&) {}
  void spin_once(std::chrono::milliseconds patience) {
    std::function<void()> next;
    {
      const std::lock_guard<std::mutex> lock(Other::one().mutex);
      if (!Other::one().waiting.empty()) {
        next = std::move(Other::one().waiting.front());
        Other::one().waiting.pop_front();
      }
    }
    if (next) {
      next();
      ++Other::one().delivered;
    } else {
      std::this_thread::sleep_for(patience / 100);  // the test has less patience than a robot
    }
  }
};
}  // namespace executors

}  // namespace rclcpp

#define RCLCPP_WARN(logger, ...)       \
  do {                                 \
    (void)(logger);                    \
    std::fprintf(stderr, __VA_ARGS__); \
    std::fputc('\n', stderr);          \
    ++rclcpp::Other::one().warnings;   \
  } while (false)
