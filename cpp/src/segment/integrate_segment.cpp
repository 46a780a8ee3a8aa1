// SPDX-License-Identifier: Apache-2.0
// One pass over the drive steps of a segment: poses, and sums that give the derivative of the last pose.
#include "slipwise/segment/integrate_segment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/segment/ground_step.hpp"
#include "slipwise/segment/growing_path.hpp"
#include "slipwise/segment/path_step.hpp"

namespace slipwise {
namespace {

/// One column per learned parameter of the actuator.
using ActuatorColumns = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kActuatorParameters>;
using LearnedColumns = Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::ColMajor, 4, kActuatorParameters>;

constexpr std::size_t kAtStart = 0;

ActuatorSpan window_of(const Segment& segment) {
  const auto [start, end] = path_span(segment);
  return {.start = start, .end = end, .initial = segment.initial, .known = segment.known, .ahead = segment.ahead};
}

bool calibrated(const Segment& segment) { return segment.measured.front().sensor.calibrated; }

ActuatorModel actuator_of(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                          const Segment& segment) {
  ActuatorModel actuator = model.actuator(parameters);
  if (calibrated(segment)) {
    actuator.clock_offset = 0.0;
  }
  return actuator;
}

/// What was measured, by sensors where a model that learns the place of the first says.
std::vector<Measured> placed(const Segment& segment, const MotionModel& model,
                             const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  std::vector<Measured> measured = segment.measured;
  for (auto& [sensor, z] : measured) {
    if (model.learned().sensor_extrinsics && !sensor.calibrated) {
      sensor.place = model.sensor_extrinsics(parameters);
    }
  }
  return measured;
}

/// What pulls the robot amid a step that begins at `theta`, and where slip is `by_heading`, its heading there.
BodyGravity under(const Segment& segment, const ActuatorStep& step, double theta, const BodyGravity* ground,
                  bool by_heading) {
  const BodyGravity pull = ground != nullptr ? *ground : BodyGravity{.gx = segment.gx, .gy = segment.gy};
  return by_heading ? headed(pull, segment.heading + theta + 0.5 * step.turn) : pull;
}

/// What derivatives are by: the slip parameters, and the others too where `all`.
struct LearnedAt {
  const MotionModel& model;
  const ActuatorModel& actuator;
  bool all;

  Eigen::Index size() const { return all ? model.size() : model.slip_size(); }
};

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

  /// Adds to the derivative of rows what comes from one of the poses that make them: Phi(n, 0) times the sums.
  void add_to(Eigen::Block<RowsJacobian> by_parameter, const RowsByPose& by_pose, const Pose2& pose,
              const LearnedAt& at) const {
    const RowsByPose phi = by_pose * transition(Pose2{}, pose);
    by_parameter.leftCols(at.model.slip_size()) += phi * slip;
    if (at.all && at.model.actuator_size() > 0) {
      by_parameter.middleCols(at.model.slip_size(), at.model.actuator_size()) +=
          phi * actuator * at.model.actuator_scales(at.actuator).asDiagonal();
    }
  }
};

/// The sums at the poses that sensors look at.
class SumsThen {
 public:
  explicit SumsThen(const std::vector<Sight>& sights) {
    for (const Sight& sight : sights) {
      places_.insert(places_.end(), sight.at.begin(), sight.at.begin() + sight.stamps.size());
    }
  }

  void see(std::size_t place, const SensitivitySums& sums) {
    if (std::ranges::find(places_, place) != places_.end()) {
      sums_.emplace_back(place, sums);
    }
  }
  const SensitivitySums& at(std::size_t place) const {
    return std::ranges::find(sums_, place, &std::pair<std::size_t, SensitivitySums>::first)->second;
  }

 private:
  std::vector<std::size_t> places_;
  std::vector<std::pair<std::size_t, SensitivitySums>> sums_;
};

/// The derivative of the rows of all sensors. One that is calibrated apart says nothing of the clock and of the place
/// that the model learns.
RowsJacobian rows_by_parameter(const SegmentPath& path, const std::vector<Seen>& seen, const SumsThen& sums,
                               const LearnedAt& at) {
  RowsJacobian by_parameter = RowsJacobian::Zero(path.directions().size(), at.size());
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Sight& sight = path.sights[k];
    Eigen::Block<RowsJacobian> rows = by_parameter.block(row, 0, seen[k].z.size(), by_parameter.cols());
    row += rows.rows();
    for (std::size_t i = 0; std::cmp_less(i, sight.stamps.size()); ++i) {
      if (const std::size_t place = sight.at[i]; place != kAtStart) {
        sums.at(place).add_to(rows, seen[k].by_pose[i], path.poses[place], at);
      }
    }
    const bool apart = path.measured[k].sensor.calibrated;
    if (at.all && !apart && at.model.learned().sensor_extrinsics) {
      rows.rightCols<kExtrinsicsParameters>() = seen[k].by_place;
    }
    const auto& places = at.model.actuator_places();
    if (const auto clock = std::ranges::find(places, kClockOffset); at.all && apart && clock != places.end()) {
      rows.col(at.model.slip_size() + (clock - places.begin())).setZero();
    }
  }
  return by_parameter;
}

SegmentLinearization linearized_path(SegmentPath path, const SumsThen& sums, const LearnedAt& at) {
  const std::vector<Seen> seen = path.seen();
  RowsJacobian by_parameter = rows_by_parameter(path, seen, sums, at);
  return {.path = std::move(path), .predicted = stacked(seen), .by_parameter = std::move(by_parameter)};
}

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

/// Cuts steps where the ground `changes` on the way, and at the moments of the sensors; returns what these look at.
std::vector<Sight> cut_steps(ActuatorSteps& drive, const Segment& segment, bool changes) {
  if (changes) {
    cut_for_ground(drive);
  }
  return cut_for_sights(drive, segment);
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
  std::vector<Sight> sights = cut_steps(drive, segment, segment.ground || by_heading);
  GrowingPath path(segment, drive.steps.size());
  SensitivitySums sums(model);
  SumsThen then(sights);
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
    then.see(k + 1, sums);
    if (k + 1 < drive.steps.size()) {
      see(path, std::span(drive.steps).first(k + 1), sums);
    }
  }
  return linearized_path(
      std::move(path).finish(std::move(drive.steps), placed(segment, model, parameters), std::move(sights)), then,
      {model, actuator, kAll});
}

void see_nothing(const GrowingPath& /*path*/, std::span<const ActuatorStep> /*steps*/,
                 const SensitivitySums& /*sums*/) {}

}  // namespace

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
  std::vector<Sight> sights = cut_steps(drive, segment, segment.ground || by_heading || !ahead.empty());
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
  return std::move(path).finish(std::move(drive.steps), placed(segment, model, parameters), std::move(sights));
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
    std::vector<Sight> sights = sights_until(steps.size(), segment);
    SumsThen then(sights);
    then.see(steps.size(), sums);
    SegmentPath so_far =
        GrowingPath(path).finish({steps.begin(), steps.end()}, placed(segment, model, parameters), std::move(sights));
    found.push_back(linearized_path(std::move(so_far), then, {model, actuator, true}));
  };
  auto whole = linearized<true>(model, parameters, inputs, segment, see);
  found.push_back(std::move(whole));
  return found;
}

}  // namespace slipwise
