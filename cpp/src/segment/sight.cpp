// SPDX-License-Identifier: Apache-2.0
// Cuts of steps at fixed moments.
#include "slipwise/segment/sight.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

/// What a step becomes before and after a fixed moment inside it.
class StepCut {
 public:
  StepCut(const ActuatorStep& step, double until) : step_(step), part_(until / step.duration) {}

  ActuatorStep before() const {
    return {step_.duration * part_, step_.forward * part_, step_.left * part_, step_.turn * part_};
  }
  ActuatorStep after() const {
    const double rest = 1.0 - part_;
    return {step_.duration * rest, step_.forward * rest, step_.left * rest, step_.turn * rest};
  }
  /// Of the part before. `started` is the derivative of the stamp at which the step starts: as that moves, the moment
  /// does not.
  ActuatorStepJacobian jacobian_before(const ActuatorStepJacobian& jacobian,
                                       const Eigen::Matrix<double, 1, kActuatorParameters>& started) const {
    const Eigen::Vector4d whole(step_.duration, step_.forward, step_.left, step_.turn);
    return jacobian * part_ + whole * ((-started - part_ * jacobian.row(0)) / step_.duration);
  }

 private:
  const ActuatorStep& step_;
  double part_;
};

/// Steps with cuts at moments that are fixed.
class CutSteps {
 public:
  explicit CutSteps(bool with_jacobians) : with_jacobians_(with_jacobians) { started_.setZero(); }

  std::size_t count() const { return steps_.steps.size(); }
  double time() const { return time_; }
  void add(const ActuatorStep& step, const ActuatorStepJacobian& jacobian) {
    steps_.steps.push_back(step);
    time_ += step.duration;
    if (with_jacobians_) {
      steps_.jacobians.push_back(jacobian);
      started_ += jacobian.row(0);
    }
  }
  /// Adds the part of a step until a moment from now, and leaves the rest of it.
  void add_until(double moment, ActuatorStep& step, ActuatorStepJacobian& jacobian) {
    const StepCut cut(step, moment);
    const ActuatorStepJacobian before =
        with_jacobians_ ? cut.jacobian_before(jacobian, started_) : ActuatorStepJacobian::Zero();
    const ActuatorStep rest = cut.after();
    add(cut.before(), before);
    step = rest;
    jacobian -= before;
  }
  ActuatorSteps take() && { return std::move(steps_); }

 private:
  bool with_jacobians_;
  double time_ = 0.0;
  Eigen::Matrix<double, 1, kActuatorParameters> started_;
  ActuatorSteps steps_;
};

/// A moment of a sight, and where its place belongs.
struct Fixed {
  double after_start;
  std::size_t* place;
};

/// Cuts steps at moments in order, and says where these are.
void cut_at(ActuatorSteps& drive, const std::vector<Fixed>& moments) {
  CutSteps cut(!drive.jacobians.empty());
  auto next = moments.begin();
  const auto place = [&] { *(next++)->place = cut.count(); };
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    ActuatorStep step = drive.steps[k];
    ActuatorStepJacobian jacobian = drive.jacobians.empty() ? ActuatorStepJacobian::Zero() : drive.jacobians[k];
    while (next != moments.end() && step.duration > 0.0 && later(cut.time() + step.duration, next->after_start)) {
      const double moment = next->after_start - cut.time();
      if (next == moments.begin() || next->after_start > std::prev(next)->after_start) {
        cut.add_until(same_stamp(moment, 0.0) ? 0.0 : moment, step, jacobian);
      }
      place();
    }
    cut.add(step, jacobian);
  }
  while (next != moments.end()) {
    place();
  }
  drive = std::move(cut).take();
}

}  // namespace

std::array<double, 2> path_span(const Segment& segment) {
  std::array<double, 2> span{segment.start, segment.end};
  for (const Measured& each : segment.measured) {
    const Moments at = moments(each.sensor, segment.start, segment.end);
    span = {std::min(span[0], at.minCoeff()), std::max(span[1], at.maxCoeff())};
  }
  return span;
}

std::array<Pose2, kMostMoments> Sight::robot(const std::vector<Pose2>& poses) const {
  std::array<Pose2, kMostMoments> then;
  for (Eigen::Index i = 0; i < stamps.size(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    then[place] = poses[at[place]];
  }
  return then;
}

std::vector<Sight> cut_for_sights(ActuatorSteps& drive, const Segment& segment) {
  const auto [start, end] = path_span(segment);
  std::vector<Sight> sights;
  std::vector<Fixed> inside;
  std::vector<std::size_t*> last;
  sights.reserve(segment.measured.size());
  for (const Measured& measured : segment.measured) {
    Sight& sight = sights.emplace_back(moments(measured.sensor, segment.start, segment.end));
    for (Eigen::Index i = 0; i < sight.stamps.size(); ++i) {
      std::size_t& place = sight.at[static_cast<std::size_t>(i)];
      if (sight.stamps[i] >= end) {
        last.push_back(&place);
      } else if (sight.stamps[i] > start) {
        inside.push_back({sight.stamps[i] - start, &place});
      }
    }
  }
  if (!inside.empty()) {
    std::ranges::stable_sort(inside, {}, &Fixed::after_start);
    cut_at(drive, inside);
  }
  for (std::size_t* place : last) {
    *place = drive.steps.size();
  }
  return sights;
}

std::vector<Sight> sights_until(std::size_t last, const Segment& segment) {
  std::vector<Sight> sights;
  for (const Measured& measured : segment.measured) {
    sights.emplace_back(moments(measured.sensor, segment.start, segment.end),
                        std::array<std::size_t, kMostMoments>{0, last});
  }
  return sights;
}

}  // namespace slipwise
