// SPDX-License-Identifier: Apache-2.0
// Courses of chords.
#include "slipwise/sensor/position_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/lie/angle.hpp"
#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

constexpr double kShortestChord = 0.05;  // [m] a shorter one that a model predicts has no course to speak of

using Positions = std::array<Eigen::Vector2d, kCoursePoints>;
using ByPosition = std::array<Eigen::Matrix<double, 3, 2>, kCoursePoints>;

/// Of the sensor, seen from where its path begins.
Positions positions(const View& view) {
  Positions points;
  for (std::size_t i = 0; i < kCoursePoints; ++i) {
    const Pose2 seen = sensor_motion(view.robot[i], view.place);
    points[i] = {seen.x, seen.y};
  }
  return points;
}

Eigen::Vector2d chord(const Positions& points, CoursePoint from, CoursePoint to) { return points[to] - points[from]; }

double course(const Eigen::Vector2d& along) { return std::atan2(along.y(), along.x()); }

/// Derivative of the course by where the chord ends.
Eigen::RowVector2d course_by_end(const Eigen::Vector2d& along) {
  const double squared = std::max(along.squaredNorm(), kShortestChord * kShortestChord);
  return Eigen::RowVector2d(-along.y(), along.x()) / squared;
}

/// Of the chart (x, y, theta) of the end as seen from the start.
ByPosition by_position(const Positions& points, const std::array<Chord, 2>& chords) {
  const Eigen::Vector2d along = chord(points, kStartChord, kStart);
  const Eigen::RowVector2d first = course_by_end(along);
  const Eigen::RowVector2d second = course_by_end(chord(points, kEndChord, kEnd));
  const Eigen::Matrix2d turned = rotation(-course(along) - chords[0].offset);
  const Eigen::Vector2d moved = turned * chord(points, kStart, kEnd);
  Eigen::Matrix<double, 3, 2> by_first;  // through the course at the start
  by_first << moved.y() * first, -moved.x() * first, -first;
  ByPosition by{-by_first, by_first, Eigen::Matrix<double, 3, 2>::Zero(), Eigen::Matrix<double, 3, 2>::Zero()};
  by[kStart].topRows<2>() -= turned;
  by[kEnd].topRows<2>() += turned;
  by[kEnd].bottomRows<1>() += second;
  by[kEndChord].bottomRows<1>() -= second;
  return by;
}

}  // namespace

Directions PositionSensor::directions() const {
  return Eigen::Matrix<Eigen::Index, 3, 1>(kAlong, kAcross, kTurn).head(turn ? 3 : 2);
}

Moments PositionSensor::moments(double start, double end) const {
  return Eigen::Vector4d(chords[0].from, start, chords[1].from, end);
}

Seen PositionSensor::see(const View& view) const {
  const Positions points = positions(view);
  const Eigen::Index rows = turn ? 3 : 2;
  const double first = course(chord(points, kStartChord, kStart)) + chords[0].offset;
  const double second = course(chord(points, kEndChord, kEnd)) + chords[1].offset;
  const Eigen::Vector2d moved = rotation(-first) * chord(points, kStart, kEnd);
  const double near = turn ? view.measured[2] : 0.0;  // the measured turn, next to which the predicted one is unwrapped
  const double turned = near + wrap_angle(second - first - near);
  const ByPosition by = by_position(points, chords);
  Seen seen{.z = Eigen::Vector3d(moved.x(), moved.y(), turned).head(rows),
            .by_pose = {},
            .by_place = RowsByPose::Zero(rows, 3)};
  for (std::size_t i = 0; i < kCoursePoints; ++i) {
    seen.by_pose[i] = by[i].topRows(rows) * sensor_by_robot(view.robot[i], view.place).topRows<2>();
    seen.by_place += by[i].topRows(rows) * sensor_by_extrinsics(view.robot[i], view.place).topRows<2>();
  }
  seen.by_place.col(2).setZero();  // an antenna has no heading
  return seen;
}

RowsCovariance PositionSensor::noise(const View& view, const MotionNoise& noise) const {
  ByPosition by = by_position(positions(view), chords);
  for (const CoursePoint same : {kStart, kStartChord}) {
    if (view.stamps[kEndChord] == view.stamps[same]) {  // one position, one error
      by[same] += by[kEndChord];
      by[kEndChord].setZero();
    }
  }
  // A course is no better a heading than a measured one. Without that, a segment with hardly any motion, whose chords
  // are almost the same, would seem to measure their difference exactly.
  MotionNoise headings = noise;
  headings.pose_std_xy = 0.0;
  Eigen::Matrix3d covariance = pose_noise_covariance({view.measured[0], view.measured[1], 0.0}, headings, std_ratio);
  for (std::size_t i = 0; i < kCoursePoints; ++i) {
    const double std = std_ratio[i < kEndChord ? 0 : 1].xy * noise.pose_std_xy;
    covariance += std * std * by[i] * by[i].transpose();
  }
  const Eigen::Index rows = turn ? 3 : 2;
  return covariance.topLeftCorner(rows, rows);
}

void PositionSensor::come_earlier(double seconds) {
  for (Chord& each : chords) {
    each.from -= seconds;
  }
}

}  // namespace slipwise
