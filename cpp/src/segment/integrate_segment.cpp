// SPDX-License-Identifier: Apache-2.0
// One pass over the drive steps of a segment: poses, and sums that give the derivative of the last pose.
#include "slipwise/segment/integrate_segment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "slipwise/linear/present.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/segment/ground_step.hpp"
#include "slipwise/segment/growing_path.hpp"
#include "slipwise/segment/path_step.hpp"
#include "slipwise/segment/sensor_motion.hpp"

namespace slipwise {
namespace {

constexpr Eigen::Index kClockOffset = 4;  // its place among the parameters of an actuator

/// One column per learned parameter of the actuator.
using ActuatorColumns = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kActuatorParameters>;
using LearnedColumns = Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::ColMajor, 4, kActuatorParameters>;

ActuatorSpan window_of(const Segment& segment) {
  return {.start = path_start(segment), .end = segment.end, .initial = segment.initial, .known = segment.known};
}

bool calibrated_apart(const Segment& segment) { return segment.source && segment.source->own_calibration; }

ActuatorModel actuator_of(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                          const Segment& segment) {
  ActuatorModel actuator = model.actuator(parameters);
  if (calibrated_apart(segment)) {
    actuator.clock_offset = 0.0;
  }
  return actuator;
}

/// A gyro says nothing of where the robot is, and a further source nothing of the clock and the sensor of the first.
void clear_unmeasured(const MotionModel& model, const Segment& segment, bool all,
                      Eigen::Matrix<double, 3, Eigen::Dynamic>& by_parameter) {
  if (segment.source && segment.source->heading_only && segment.gyro_std) {
    by_parameter.topRows<2>().setZero();
  }
  if (!all || !calibrated_apart(segment)) {
    return;
  }
  by_parameter.rightCols(model.extrinsics_size()).setZero();
  const auto& places = model.actuator_places();
  const auto clock = std::ranges::find(places, kClockOffset);
  if (clock != places.end()) {
    by_parameter.col(model.slip_size() + (clock - places.begin())).setZero();
  }
}

Pose2 sensor_of(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters, const Segment& segment) {
  return model.learned().sensor_extrinsics && !calibrated_apart(segment) ? model.sensor_extrinsics(parameters)
                                                                         : segment.sensor;
}

/// What pulls the robot amid a step that begins at `theta`, and where slip is `by_heading`, its heading there.
BodyGravity under(const Segment& segment, const ActuatorStep& step, double theta, const BodyGravity* ground,
                  bool by_heading) {
  const BodyGravity pull = ground != nullptr ? *ground : BodyGravity{.gx = segment.gx, .gy = segment.gy};
  return by_heading ? headed(pull, segment.heading + theta + 0.5 * step.turn) : pull;
}

/// Sums of derivations/model.md: the steps' derivatives carried back to the path's start, one column per
/// parameter.
struct SensitivitySums {
  Eigen::Matrix<double, 3, Eigen::Dynamic> slip;
  ActuatorColumns actuator;
  Eigen::Matrix<double, 1, Eigen::Dynamic> started;  ///< the stamp at which the next step on ground starts

  explicit SensitivitySums(const MotionModel& model)
      : slip(3, model.slip_size()), actuator(3, model.actuator_size()), started(model.actuator_size()) {
    slip.setZero();
    actuator.setZero();
    started.setZero();
  }

  /// d(tangent) / d(alpha) is the feature times the duration, in the term's own channel.
  void add_slip(const Basis& basis, const Eigen::Matrix3d& by_tangent, std::span<const double> features,
                double duration) {
    for (const Channel channel : {Channel::Lon, Channel::Lat, Channel::Ang}) {
      const Eigen::Vector3d column = by_tangent.col(static_cast<Eigen::Index>(channel)) * duration;
      for (std::size_t i = basis.begin(channel); i < basis.end(channel); ++i) {
        slip.col(static_cast<Eigen::Index>(i)) += column * features[i];
      }
    }
  }

  /// What follows from where and when the step is driven: `by_place` is the derivative of the path's start by what the
  /// ground is evaluated at. `step` has a column for each actuator parameter.
  void add_ground(const Eigen::Matrix3d& by_place, const GroundStepLinearization& at, const Pose2& before,
                  const std::optional<LearnedColumns>& step) {
    if (!at.at_by_pose.isZero(0.0)) {  // zero of a measured attitude, which hangs on the stamps alone
      const Eigen::Matrix3d by_start = by_place * at.at_by_pose * transition(Pose2{}, before);
      slip += (by_start * slip).eval();
      actuator += (by_start * actuator).eval();
    }
    if (step) {
      actuator += by_place * (at.at_by_step * *step + at.at_by_time * started);
      started += step->row(0);
    }
  }

  /// Derivatives of the heading amid a step by slip and by the actuator, before anything of the step is added.
  std::array<Eigen::RowVectorXd, 2> heading_amid(const std::optional<LearnedColumns>& step) const {
    std::array<Eigen::RowVectorXd, 2> amid{slip.row(2), actuator.row(2)};
    if (step) {
      amid[1] += 0.5 * step->row(3);
    }
    return amid;
  }

  /// Phi(n, 0), carried from the robot to the sensor.
  static Eigen::Matrix3d at_sensor(const Pose2& end, const Pose2& sensor) {
    return sensor_by_robot(end, sensor) * transition(Pose2{}, end);
  }

  Eigen::Matrix<double, 3, Eigen::Dynamic> by_slip(const Pose2& end, const Pose2& sensor) const {
    return at_sensor(end, sensor) * slip;
  }

  /// J = Phi(n, 0) times the sums.
  Eigen::Matrix<double, 3, Eigen::Dynamic> at(const Pose2& end, const Pose2& sensor, const MotionModel& model,
                                              const ActuatorModel& at) const {
    const Eigen::Matrix3d phi = at_sensor(end, sensor);
    Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, model.size());
    jacobian.leftCols(model.slip_size()) = phi * slip;
    if (model.actuator_size() > 0) {
      jacobian.middleCols(model.slip_size(), model.actuator_size()) =
          phi * actuator * model.actuator_scales(at).asDiagonal();
    }
    if (model.learned().sensor_extrinsics) {
      jacobian.rightCols<kExtrinsicsParameters>() = sensor_by_extrinsics(end, sensor);
    }
    return jacobian;
  }
};

/// What a step is driven on, and how that follows from the parameters; nothing on level ground.
struct GroundUnder {
  GroundStep step;
  std::optional<GroundStepLinearization> moved;  ///< a measured attitude depends on the actuator alone

  static std::optional<GroundUnder> find(const Segment& segment, const ActuatorStep& step, const GrowingPath& path,
                                         bool by_actuator) {
    if (!segment.ground) {
      return std::nullopt;
    }
    if (!by_actuator && std::holds_alternative<MeasuredTilts>(*segment.ground)) {
      return GroundUnder{ground_step(*segment.ground, step, path.pose(), path.time()), std::nullopt};
    }
    auto moved = linearize_ground_step(*segment.ground, step, path.pose(), path.time());
    return GroundUnder{moved.step, std::move(moved)};
  }
};

/// A step as it was driven.
struct DrivenStep {
  const ActuatorStep& step;
  const PathSlip& along;
  std::span<const double> features;
  const Eigen::Vector3d& slip;
  const Eigen::Vector3d& body;  ///< its tangent in the robot's axes
  const Pose2& before;          ///< where it begins
  const std::optional<GroundUnder>& ground;
};

/// Adds to the sums what follows from a step. `learned` has a column for each actuator parameter that is learned, and
/// `by_tangent` is the derivative of the path's start by the tangent seen from above.
void add_step(SensitivitySums& sums, const DrivenStep& driven, const std::optional<LearnedColumns>& learned,
              Eigen::Matrix3d by_tangent) {
  const auto& [step, along, features, slip, body, before, ground] = driven;
  const auto amid = along.basis.by_heading() ? std::optional(sums.heading_amid(learned)) : std::nullopt;
  if (ground && ground->moved) {
    sums.add_ground(by_tangent * above_by_place(*ground->moved, step, along, body), *ground->moved, before, learned);
  }
  if (ground) {
    by_tangent = (by_tangent * ground->step.level).eval();
  }
  if (amid) {
    const Eigen::Vector3d rate = slip_rate_by_heading(along.basis, along.alpha, slip_state(step, along.gravity));
    const Eigen::Vector3d by_heading = by_tangent * rate * step.duration;
    sums.slip += by_heading * (*amid)[0];
    sums.actuator += by_heading * (*amid)[1];
  }
  sums.add_slip(along.basis, by_tangent, features, step.duration);
  if (learned && !learned->isZero(0.0)) {
    sums.actuator += by_tangent * tangent_by(step, *learned, along, slip);
  }
}

/// Cuts steps where the ground `changes` on the way, and at the points of the segment's course; returns where these
/// are, if it has one.
std::optional<CoursePlaces> cut_steps(ActuatorSteps& drive, const Segment& segment, bool changes) {
  if (changes) {
    cut_for_ground(drive);
  }
  return segment.chords ? std::optional(cut_for_course(drive, segment)) : std::nullopt;
}

/// The derivative of a course by those of the sensor's poses at its points; those at the path's start have none.
Eigen::Matrix<double, 3, Eigen::Dynamic> of_course(
    const SegmentPath& path, const std::array<Eigen::Matrix<double, 3, Eigen::Dynamic>, kCoursePoints>& at_points,
    Eigen::Index parameters) {
  const CoursePlaces& course = present(path.course);
  const ByPosition by_position = course_by_position(path.course_positions(), course);
  Eigen::Matrix<double, 3, Eigen::Dynamic> sum = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, parameters);
  for (std::size_t i = 0; i < kCoursePoints; ++i) {
    if (course.at[i] > 0) {
      sum += by_position[i] * at_points[i].topRows<2>();
    }
  }
  if (course.gyro_std) {
    sum.row(2) += at_points[kEnd].row(2);
    if (course.at[kStart] > 0) {
      sum.row(2) -= at_points[kStart].row(2);
    }
  }
  return sum;
}

/// By the slip parameters, and by the others too where `kAll`. After each step but the last, `see` is handed the path,
/// the steps and the sums so far.
template <bool kAll, class See>
SegmentLinearization linearized(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                const InputHistory& inputs, const Segment& segment, const See& see) {
  model.check(parameters);
  const ActuatorModel actuator = actuator_of(model, parameters, segment);
  const bool by_actuator = kAll && model.actuator_size() > 0;
  const bool by_heading = model.basis().by_heading();
  const auto alpha = parameters.head(model.slip_size());
  ActuatorSteps drive = by_actuator ? linearize_actuator_steps(inputs, actuator, window_of(segment))
                                    : actuator_steps(inputs, actuator, window_of(segment));
  const std::optional<CoursePlaces> course = cut_steps(drive, segment, segment.ground || by_heading);
  const Pose2 sensor = sensor_of(model, parameters, segment);
  std::array<Eigen::Matrix<double, 3, Eigen::Dynamic>, kCoursePoints> at_points;
  GrowingPath path(segment, drive.steps.size());
  SensitivitySums sums(model);
  const auto at_sensor = [&] {
    return kAll ? sums.at(path.pose(), sensor, model, actuator) : sums.by_slip(path.pose(), sensor);
  };
  std::vector<double> features(model.basis().size());
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    const ActuatorStep& step = drive.steps[k];
    const auto ground = GroundUnder::find(segment, step, path, by_actuator);
    const PathSlip along{model.basis(), alpha,
                         under(segment, step, path.pose().theta, ground ? &ground->step.gravity : nullptr, by_heading)};
    model.basis().features(slip_state(step, along.gravity), features);
    const Eigen::Vector3d slip = slip_rate(model.basis(), alpha, features);
    const Eigen::Vector3d body = tangent_of(step, slip);
    const Pose2 before = path.pose();
    const Eigen::Matrix3d by_tangent =
        append_linearized(path, step.duration, ground ? ground->step.seen_from_above(body) : body);
    const DrivenStep driven{step, along, features, slip, body, before, ground};
    add_step(sums, driven,
             by_actuator ? std::optional<LearnedColumns>(drive.jacobians[k](Eigen::all, model.actuator_places()))
                         : std::nullopt,
             by_tangent);
    for (std::size_t i = 0; course && i < kCoursePoints; ++i) {
      if (course->at[i] == k + 1) {
        at_points[i] = at_sensor();
      }
    }
    if (k + 1 < drive.steps.size()) {
      see(path, std::span(drive.steps).first(k + 1), sums);
    }
  }
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_parameter = at_sensor();
  SegmentPath finished = std::move(path).finish(std::move(drive.steps), sensor, course);
  if (course) {
    by_parameter = of_course(finished, at_points, by_parameter.cols());
  }
  clear_unmeasured(model, segment, kAll, by_parameter);
  const Pose2 predicted = finished.sensor_motion();
  return {std::move(finished), predicted, std::move(by_parameter)};
}

void see_nothing(const GrowingPath& /*path*/, std::span<const ActuatorStep> /*steps*/,
                 const SensitivitySums& /*sums*/) {}

}  // namespace

CoursePositions SegmentPath::course_positions() const {
  CoursePositions points;
  for (std::size_t i = 0; i < kCoursePoints; ++i) {
    const Pose2 seen = slipwise::sensor_motion(poses[present(course).at[i]], sensor);
    points[i] = {seen.x, seen.y};
  }
  return points;
}

double SegmentPath::course_turn() const {
  return poses[present(course).at[kEnd]].theta - poses[present(course).at[kStart]].theta;
}

Pose2 SegmentPath::sensor_motion() const {
  if (heading_std) {
    return {0.0, 0.0, poses.back().theta};
  }
  return course ? course_motion(course_positions(), *course, course_turn())
                : slipwise::sensor_motion(poses.back(), sensor);
}

Pose2 SegmentPath::robot_motion(const Pose2& measured) const {
  return compose(compose(sensor, measured), inverse(sensor));
}

// NOLINTNEXTLINE(readability-function-size): a model, what is driven, how it is integrated and what lies ahead.
SegmentPath integrate_segment(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                              const InputHistory& inputs, const Segment& segment, Integrator integrator,
                              const SlipAhead& ahead) {
  model.check(parameters);
  check_ahead(ahead, model.slip_size());
  Eigen::VectorXd alpha = parameters.head(model.slip_size());
  const bool by_heading = model.basis().by_heading();
  double travelled = 0.0;
  ActuatorSteps drive = actuator_steps(inputs, actuator_of(model, parameters, segment), window_of(segment));
  const std::optional<CoursePlaces> course = cut_steps(drive, segment, segment.ground || by_heading || !ahead.empty());
  GrowingPath path(segment, drive.steps.size());
  std::vector<double> features(model.basis().size());
  for (const ActuatorStep& step : drive.steps) {
    const auto ground =
        segment.ground ? std::optional(ground_step(*segment.ground, step, path.pose(), path.time())) : std::nullopt;
    const BodyGravity gravity =
        under(segment, step, path.pose().theta, ground ? &ground->gravity : nullptr, by_heading);
    model.basis().features(slip_state(step, gravity), features);
    if (!ahead.empty()) {
      alpha = slip_over(ahead, parameters.head(model.slip_size()), travelled, std::abs(step.forward));
    }
    const Eigen::Vector3d body = tangent_of(step, slip_rate(model.basis(), alpha, features));
    travelled += std::abs(body.x());
    const Eigen::Vector3d tangent = ground ? ground->seen_from_above(body) : body;
    const auto arc = arc_functions(tangent.z());
    const Eigen::Vector2d displacement = integrator == Integrator::Exact
                                             ? Eigen::Vector2d(arc_matrix(arc) * tangent.head<2>())
                                             : rk4_displacement(tangent);
    path.append(step.duration, tangent, displacement, arc);
  }
  return std::move(path).finish(std::move(drive.steps), sensor_of(model, parameters, segment), course);
}

SegmentLinearization linearize_segment(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                       const InputHistory& inputs, const Segment& segment) {
  return linearized<true>(model, parameters, inputs, segment, see_nothing);
}

SegmentLinearization linearize_slip(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                    const InputHistory& inputs, const Segment& segment) {
  return linearized<false>(model, parameters, inputs, segment, see_nothing);
}

std::vector<SegmentLinearization> linearize_beginnings(const MotionModel& model,
                                                       const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                       const InputHistory& inputs, const Segment& segment,
                                                       std::size_t parts) {
  const ActuatorModel actuator = actuator_of(model, parameters, segment);
  const Pose2 sensor = sensor_of(model, parameters, segment);
  const double part = (segment.end - segment.start) / static_cast<double>(parts);
  double next = segment.start + part;
  std::vector<SegmentLinearization> found;
  const auto see = [&](const GrowingPath& path, std::span<const ActuatorStep> steps, const SensitivitySums& sums) {
    if (later(next, path.time())) {
      return;
    }
    while (!later(next, path.time())) {
      next += part;
    }
    SegmentPath so_far = GrowingPath(path).finish({steps.begin(), steps.end()}, sensor);
    const Pose2 predicted = so_far.sensor_motion();
    auto by_parameter = sums.at(so_far.poses.back(), sensor, model, actuator);
    found.push_back({std::move(so_far), predicted, std::move(by_parameter)});
  };
  auto whole = linearized<true>(model, parameters, inputs, segment, see);
  found.push_back(std::move(whole));
  return found;
}

}  // namespace slipwise
