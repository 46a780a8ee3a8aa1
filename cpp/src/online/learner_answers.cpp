// SPDX-License-Identifier: Apache-2.0
// What a learner is asked: a path from now on, the model so far, the limits of the actuator, where the robot is.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/actuator/measured_start.hpp"
#include "slipwise/filter/base_link_model.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/behind_limits.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/stamp_spacing.hpp"
#include "slipwise/online/student_t.hpp"
#include "slipwise/segment/input_spread.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

constexpr double kLongest = 3600.0;    // [s] horizon
constexpr double kFastestInput = 1e3;  // [m/s, rad/s]
constexpr std::size_t kPathPoses = 5;  // of a prediction
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kOffsets = 1.5;  // [s] states are kept for longer than streams are late: no clock offset is larger

/// Variance of a Student t over that of the normal with its scale.
double spread(const StudentT& student) { return student.inflation * student.dof / std::max(student.dof - 2.0, 1.0); }

void check(const std::vector<InputSample>& future, double horizon) {
  if (!(horizon > 0.0) || horizon > kLongest) {
    throw std::invalid_argument("the horizon must be positive and at most " + std::to_string(kLongest) + " s, got " +
                                std::to_string(horizon));
  }
  double before = -kNever;
  for (const auto& [t, twist] : future) {
    const double fastest = std::max({std::abs(twist.v), std::abs(twist.vy), std::abs(twist.omega)});
    if (!(t > before) || !std::isfinite(t) || !(fastest <= kFastestInput)) {
      throw std::invalid_argument("future inputs must be finite, in m/s and rad/s, and their stamps must increase");
    }
    before = t;
  }
}

/// The same of base_link, by the clock of the inputs.
MotionPosterior of_base_link(MotionPosterior posterior) {
  KnownModel body = of_base_link(posterior.model, posterior.estimate);
  posterior.model = std::move(body.model);
  posterior.estimate = std::move(body.estimate);
  posterior.prior_std.conservativeResize(posterior.model.size());
  return posterior;
}

/// The inputs behind the limits of a drive, whose twist may have been measured at the start.
InputHistory limited_ahead(const DrivenSegment& ahead, const ActuatorModel& actuator, const CommandLimits& limits) {
  const Segment& segment = ahead.segment;
  return segment.initial
             ? limited_inputs(ahead.inputs, limits, measured_start(actuator, segment.start, *segment.initial))
             : limited_inputs(ahead.inputs, limits);
}

/// The beginnings of what lies ahead, each pushed by what pushes it on the whole.
std::vector<SegmentLinearization> pushed_beginnings(const MotionPosterior& motion, const DrivenSegment& ahead,
                                                    const ForceBuffer& forces) {
  std::vector<SegmentLinearization> found;
  Segment part = ahead.segment;
  for (std::size_t i = 1; i <= kPathPoses; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kPathPoses);
    part.end = ahead.segment.start + share * (ahead.segment.end - ahead.segment.start);
    const KnownForce force = forces.mean(part.start, part.end).value_or(KnownForce{});
    part.gx = force.x;
    part.gy = force.y;
    found.push_back(linearize_segment(motion.model, motion.estimate.mean, ahead.inputs, part));
  }
  return found;
}

}  // namespace

/// Segments that are complete with all that was pushed, and not learned yet.
std::vector<DrivenSegment> MotionLearner::complete_now() const {
  std::vector<DrivenSegment> complete;
  for (const StreamItem& item : waiting_) {
    if (const auto* segment = std::get_if<DrivenSegment>(&item)) {
      complete.push_back(*segment);
    }
    if (const auto* source = std::get_if<SourceSegment>(&item); source != nullptr && source->source == 0) {
      complete.push_back(source->driven);
    }
  }
  std::ranges::move(sources_.waiting(), std::back_inserter(complete));
  for (DrivenSegment& segment : stream_.pending_segments()) {
    complete.push_back(std::move(segment));
  }
  const double since = stream_.newest() - kRecent * settings_.stream.segment_length;
  std::erase_if(complete, [&](const DrivenSegment& each) { return !later(each.segment.start, since); });
  return complete;
}

/// Where slip is after all that was measured, of a drive with these limits.
SlipNow MotionLearner::slip_at_newest(const Knowledge& known, const CommandLimits& limits) {
  std::vector<DrivenSegment> complete = settings_.learn_disturbance ? complete_now() : std::vector<DrivenSegment>{};
  SegmentList recent = known_.segments_before(stream_.newest());
  std::vector<DrivenSegment> limited;
  if (!unlimited(limits)) {
    limited.reserve(recent.size());
    for (const DrivenSegment*& each : recent) {
      each = &limited.emplace_back(behind(*each, limits));
    }
    std::ranges::transform(complete, complete.begin(), [&](const DrivenSegment& each) { return behind(each, limits); });
  }
  SlipNow slip = known_.slip_after(*known.disturbance, known.motion, recent);
  for (const DrivenSegment& segment : complete) {
    known.disturbance->follow(*known.motion, slip, segment);
  }
  return slip;
}

PredictedPath MotionLearner::predict(const std::vector<InputSample>& future, double horizon, double embargo,
                                     const KnownAhead& known) {
  check(future, horizon);
  const auto counted = [this](auto samples) {
    std::ranges::for_each(samples, [this](auto& sample) { sample.t = clock_.counted(sample.t); });
    return samples;
  };
  const std::vector<InputSample> inputs = counted(future);
  if (stream_.newest() == -kNever) {
    throw std::invalid_argument("nothing was measured in this run yet: push measurements before a prediction");
  }
  work_until(stream_.newest() - kReady);
  Knowledge knowledge = known_.at(stream_.newest() - std::max(embargo, kReady));
  const Structure structure = knowledge.motion->structure;  // whose errors are known
  DrivenSegment ahead = stream_.drive().ahead(stream_.over(stream_.newest(), stream_.newest() + horizon), inputs);
  ahead.segment.measured = measured_pose({});
  CommandLimits limits;
  if (known.limits != nullptr && known.limits->posterior != nullptr) {
    knowledge.motion = known.limits->posterior;
    limits = known.limits->search.drive.limits;
    ahead.inputs = limited_ahead(ahead, knowledge.motion->model.actuator(knowledge.motion->estimate.mean), limits);
  }
  const SlipNow slip = slip_at_newest(knowledge, limits);
  const MotionPosterior motion = of_base_link(*aged(knowledge, ahead.segment));
  const auto beginnings =
      known.forces.empty()
          ? linearize_beginnings(motion.model, motion.estimate.mean, ahead.inputs, ahead.segment, kPathPoses)
          : pushed_beginnings(motion, ahead, stream_.drive().forces_ahead(stream_.newest(), counted(known.forces)));
  PredictedPath path{.start = stream_.newest(),
                     .t = {},
                     .poses = {},
                     .covariances = {},
                     .students = {},
                     .structure = knowledge.motion->structure};
  std::ranges::transform(beginnings, std::back_inserter(path.t),
                         [](const SegmentLinearization& part) { return part.path.times.back(); });
  path.t.back() = ahead.segment.end;
  const auto along = knowledge.disturbance->predict_along(motion, slip, beginnings, ahead.segment);
  const auto of_inputs =
      input_covariances(motion.model, motion.estimate.mean, ahead,
                        stream_.drive().spread_ahead(path.start, path.start + horizon, inputs), path.t);
  for (std::size_t i = 0; i < along.size(); ++i) {
    path.students.push_back(errors_.student(stream_.newest(), path.t[i] - path.start, structure));
    path.poses.emplace_back(along[i].pose);
    path.covariances.emplace_back(path.students.back().inflation * along[i].covariance + of_inputs[i]);
  }
  path.start = clock_.stamp(path.start);
  std::ranges::for_each(path.t, [this](double& t) { t = clock_.stamp(t); });
  return path;
}

LearnedModel MotionLearner::model() const {
  const MotionLearner complete = completed();
  LearnedModel learned{.known = complete.known_.newest(),
                       .students = complete.errors_.nominal(complete.known_.newest().motion->structure),
                       .held_out = complete.errors_.predictions(),
                       .weights = complete.hypotheses_.weights(),
                       .range = complete.stream_.range(),
                       .rates = complete.stream_.rates(),
                       .held = complete.stream_.held(),
                       .steepest = complete.stream_.steepest(),
                       .seconds = complete.seconds_,
                       .segments = complete.hypotheses_.count(),
                       .rejected = complete.log_.rejected(),
                       .car = complete.stream_.drive().car_curves(),
                       .evidence = complete.stream_.evidence()};
  learned.known.until = clock_.stamp(learned.known.until);
  const double spacing = complete.stream_.wheel_interval();
  learned.known.motion = supported(learned.known.motion, spacing, learned.segments);
  learned.known.slip = supported(learned.known.slip, spacing, learned.segments);
  return learned;
}

std::optional<ActuatorLimits> MotionLearner::find_limits(double wheel_separation) const {
  if (settings_.hypotheses.wheelbase > 0.0) {
    return std::nullopt;  // limits are of yaw rates, and this drive is told curvatures
  }
  const MotionLearner complete = completed();
  return complete.limits_.find(complete.hypotheses_, *complete.known_.newest().motion, settings_.hypotheses,
                               wheel_separation);
}

PoseFilterSettings pose_filter_settings(const LearnerSettings& settings) {
  const MotionNoise& shape = settings.hypotheses.filter.noise.shape;
  return {.nominal = {.xy = shape.pose_std_xy, .yaw = shape.pose_std_yaw},
          .late_factor = settings.stream.rules.late_factor,
          .keep = settings.stream.latency + kOffsets};
}

/// By what was known a while before each time, so that it does not depend on how fast segments are learned.
MotionNow MotionLearner::motion_now() {
  const auto at = [this](double t, double horizon) -> LegKnowledge {
    const Knowledge& known = known_.at(t - kReady);
    return {.posterior = known.motion,
            .disturbance = known.disturbance,
            .slip = known_.slip_after(*known.disturbance, known.motion, known_.segments_before(t - kReady)),
            .inflation = spread(errors_.student(t, horizon, known.motion->structure))};
  };
  const auto leg = [this](const LegKnowledge& known, double start, double end) {
    return motion_leg(known, stream_.drive().stretch(stream_.over(start, end), leg_memory(*known.posterior)));
  };
  const auto clock = known_.at(stream_.newest() - kReady).clock;
  return {.inputs = stream_.drive().inputs(),
          .newest = stream_.newest(),
          .latency = settings_.stream.latency,
          .learned = seconds_,
          .late = clock ? pose_lateness(*clock, stream_.wheel_interval()) : PoseLateness{},
          .at = at,
          .leg = leg};
}

std::optional<Odometry> MotionLearner::odometry() {
  std::optional<Odometry> found = localizer_.odometry(motion_now());
  if (found) {
    found->t = clock_.stamp(found->t);
  }
  return found;
}

MotionState MotionLearner::motion_monitor() {
  MotionState state = localizer_.monitor(motion_now());
  if (state.since) {
    state.since = clock_.stamp(*state.since);
  }
  return state;
}

}  // namespace slipwise
