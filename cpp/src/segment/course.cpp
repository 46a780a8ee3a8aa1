// SPDX-License-Identifier: Apache-2.0
// Courses of chords, and cuts of steps at fixed moments.
#include "slipwise/segment/course.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kShortestChord = 0.05;  // [m] a shorter one that a model predicts has no course to speak of

Eigen::Vector2d chord(const CoursePositions& points, CoursePoint from, CoursePoint to) {
  return points[to] - points[from];
}

double course(const Eigen::Vector2d& along) { return std::atan2(along.y(), along.x()); }

/// Derivative of the course by where the chord ends.
Eigen::RowVector2d course_by_end(const Eigen::Vector2d& along) {
  const double squared = std::max(along.squaredNorm(), kShortestChord * kShortestChord);
  return Eigen::RowVector2d(-along.y(), along.x()) / squared;
}

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

}  // namespace

double path_start(const Segment& segment) {
  if (!segment.chords) {
    return segment.start;
  }
  return std::min({segment.start, (*segment.chords)[0].from, (*segment.chords)[1].from});
}

CoursePlaces cut_for_course(ActuatorSteps& drive, const Segment& segment) {
  const auto& [first, second] = present(segment.chords);
  const double start = path_start(segment);
  std::array<std::pair<double, CoursePoint>, 3> moments{
      {{first.from - start, kStartChord}, {segment.start - start, kStart}, {second.from - start, kEndChord}}};
  std::ranges::sort(moments);
  CoursePlaces places{
      .at = {}, .offset = {first.offset, second.offset}, .turn = segment.measured.theta, .gyro_std = segment.gyro_std};
  CutSteps cut(!drive.jacobians.empty());
  auto next = moments.begin();
  const auto place = [&] { places.at[(next++)->second] = cut.count(); };
  while (next != moments.end() && next->first <= 0.0) {
    place();
  }
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    ActuatorStep step = drive.steps[k];
    ActuatorStepJacobian jacobian = drive.jacobians.empty() ? ActuatorStepJacobian::Zero() : drive.jacobians[k];
    while (next != moments.end() && step.duration > 0.0 && later(cut.time() + step.duration, next->first)) {
      const double moment = next->first - cut.time();
      if (next == moments.begin() || next->first > std::prev(next)->first) {
        cut.add_until(same_stamp(moment, 0.0) ? 0.0 : moment, step, jacobian);
      }
      place();
    }
    cut.add(step, jacobian);
  }
  while (next != moments.end()) {
    place();
  }
  places.at[kEnd] = cut.count();
  drive = std::move(cut).take();
  return places;
}

Pose2 course_motion(const CoursePositions& points, const CoursePlaces& places, double turned) {
  const double first = course(chord(points, kStartChord, kStart)) + places.offset[0];
  const double second = course(chord(points, kEndChord, kEnd)) + places.offset[1];
  const Eigen::Vector2d moved = rotation(-first) * chord(points, kStart, kEnd);
  const double turn = places.gyro_std ? turned : places.turn + wrap_angle(second - first - places.turn);
  return {moved.x(), moved.y(), turn};
}

ByPosition course_by_position(const CoursePositions& points, const CoursePlaces& places) {
  const Eigen::Vector2d along = chord(points, kStartChord, kStart);
  const Eigen::RowVector2d first = course_by_end(along);
  const Eigen::RowVector2d second = course_by_end(chord(points, kEndChord, kEnd));
  const Eigen::Matrix2d turned = rotation(-course(along) - places.offset[0]);
  const Eigen::Vector2d moved = turned * chord(points, kStart, kEnd);
  Eigen::Matrix<double, 3, 2> by_first;  // through the course at the start
  by_first << moved.y() * first, -moved.x() * first, -first;
  ByPosition by{-by_first, by_first, Eigen::Matrix<double, 3, 2>::Zero(), Eigen::Matrix<double, 3, 2>::Zero()};
  by[kStart].topRows<2>() -= turned;
  by[kEnd].topRows<2>() += turned;
  by[kEnd].bottomRows<1>() += second;
  by[kEndChord].bottomRows<1>() -= second;
  if (places.gyro_std) {
    for (auto& of_point : by) {
      of_point.bottomRows<1>().setZero();
    }
  }
  return by;
}

}  // namespace slipwise
