// SPDX-License-Identifier: Apache-2.0
// A learner that threads of Python may share: one of them works with it at a time.
#pragma once

#include <nanobind/nanobind.h>

#include <mutex>
#include <type_traits>
#include <utility>

#include "slipwise/online/motion_learner.hpp"

namespace slipwise::bindings {

/// A learner and who works with it. Its long methods release the interpreter's lock, which no longer orders the
/// others then.
class Learner : public MotionLearner {
 public:
  explicit Learner(const LearnerSettings& settings) : MotionLearner(settings) {}
  explicit Learner(MotionLearner learner) : MotionLearner(std::move(learner)) {}
  Learner(Learner&& other) noexcept : MotionLearner(std::move(other)) {}

  /// Waits without the interpreter's lock: whoever is at work may need it to end.
  std::unique_lock<std::mutex> hold() {
    std::unique_lock lock(busy_, std::try_to_lock);
    if (!lock) {
      const nanobind::gil_scoped_release released;
      lock.lock();
    }
    return lock;
  }

 private:
  std::mutex busy_;
};

template <class Result>
using Given = std::conditional_t<std::is_same_v<std::remove_cvref_t<Result>, MotionLearner>, Learner,
                                 std::remove_cvref_t<Result>>;

template <class Use, class Self, class Result, class... Arguments>
auto locked_as(Use use, Result (* /*form*/)(Self, Arguments...)) {
  return [use](Learner& learner, Arguments... arguments) -> Given<Result> {
    const auto held = learner.hold();
    return Given<Result>(use(static_cast<Self>(learner), std::forward<Arguments>(arguments)...));
  };
}

/// A method for Python that waits until no other thread works with the learner.
template <class Result, class... Arguments>
auto locked(Result (MotionLearner::*method)(Arguments...)) {
  const auto use = [method](MotionLearner& learner, Arguments... arguments) -> Result {
    return (learner.*method)(std::forward<Arguments>(arguments)...);
  };
  return locked_as(use, static_cast<Result (*)(MotionLearner&, Arguments...)>(nullptr));
}
template <class Result, class... Arguments>
auto locked(Result (MotionLearner::*method)(Arguments...) const) {
  const auto use = [method](const MotionLearner& learner, Arguments... arguments) -> Result {
    return (learner.*method)(std::forward<Arguments>(arguments)...);
  };
  return locked_as(use, static_cast<Result (*)(const MotionLearner&, Arguments...)>(nullptr));
}
template <class Use>
auto locked(Use use) {
  return locked_as(use, +use);
}

}  // namespace slipwise::bindings
