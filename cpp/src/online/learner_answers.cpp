// SPDX-License-Identifier: Apache-2.0
// What a learner is asked: a path from now on, the model so far, the limits of the actuator.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/pose_limits.hpp"
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

std::size_t index(Structure structure) { return static_cast<std::size_t>(structure); }

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

/// The same of base_link, by the clock of the inputs: without the pose sensor's place and clock, which are the last
/// parameters.
MotionPosterior of_base_link(MotionPosterior posterior) {
  ActuatorParameters learned = posterior.model.learned();
  learned.sensor_extrinsics = learned.clock_offset = false;
  posterior.model = MotionModel(posterior.model.basis(), learned);
  const Eigen::Index kept = posterior.model.size();
  posterior.estimate.mean.conservativeResize(kept);
  posterior.estimate.covariance.conservativeResize(kept, kept);
  posterior.prior_std.conservativeResize(kept);
  return posterior;
}

}  // namespace

StudentT MotionLearner::student_for(double horizon, Structure structure) const {
  return student_at(stream_.newest(), horizon, structure);
}

/// Of the nearest horizon whose errors are known at `t` [s].
StudentT MotionLearner::student_at(double t, double horizon, Structure structure) const {
  const auto& horizons = settings_.stream.horizons;
  if (horizons.empty()) {
    return {.inflation = 1.0, .dof = kMostDof};
  }
  const auto apart = [&](double each) { return std::abs(std::log(each / horizon)); };
  const auto nearest = std::ranges::min_element(horizons, {}, apart);
  const HorizonErrors& errors = errors_[static_cast<std::size_t>(nearest - horizons.begin())];
  return errors.before(t - std::max(*nearest, kReady)).students[index(structure)];
}

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

PredictedPath MotionLearner::predict(const std::vector<InputSample>& future, double horizon, double embargo) {
  check(future, horizon);
  std::vector<InputSample> inputs = future;
  std::ranges::for_each(inputs, [this](InputSample& sample) { sample.t = clock_.counted(sample.t); });
  if (stream_.newest() == -kNever) {
    throw std::invalid_argument("nothing was measured in this run yet: push measurements before a prediction");
  }
  work_until(stream_.newest() - kReady);
  const Knowledge& known = known_at(stream_.newest() - std::max(embargo, kReady));
  DrivenSegment ahead = stream_.segment_ahead(horizon, inputs);
  ahead.segment.sensor = {};
  SlipNow slip = recent_slip_.after(*known.disturbance, known.motion, recent_before(stream_.newest()));
  if (settings_.learn_disturbance) {
    for (const DrivenSegment& segment : complete_now()) {
      known.disturbance->follow(*known.motion, slip, segment);
    }
  }
  const MotionPosterior motion = of_base_link(*aged(known, ahead.segment));
  const auto beginnings =
      linearize_beginnings(motion.model, motion.estimate.mean, ahead.inputs, ahead.segment, kPathPoses);
  PredictedPath path{.start = stream_.newest(),
                     .t = {},
                     .poses = {},
                     .covariances = {},
                     .students = {},
                     .structure = known.motion->structure};
  std::ranges::transform(beginnings, std::back_inserter(path.t),
                         [](const SegmentLinearization& part) { return part.path.times.back(); });
  path.t.back() = ahead.segment.end;
  const auto along = known.disturbance->predict_along(motion, slip, beginnings, ahead.segment);
  const auto of_inputs =
      input_covariances(motion.model, motion.estimate.mean, ahead, stream_.spread_ahead(horizon, inputs), path.t);
  for (std::size_t i = 0; i < along.size(); ++i) {
    path.students.push_back(student_for(path.t[i] - path.start, known.motion->structure));
    path.poses.push_back(along[i].pose);
    path.covariances.emplace_back(path.students.back().inflation * along[i].covariance + of_inputs[i]);
  }
  path.start = clock_.stamp(path.start);
  std::ranges::for_each(path.t, [this](double& t) { t = clock_.stamp(t); });
  return path;
}

LearnedModel MotionLearner::model() const {
  const MotionLearner complete = completed();
  LearnedModel learned{.known = complete.known_.back(),
                       .students = {},
                       .held_out = complete.held_out_,
                       .weights = complete.hypotheses_.weights(),
                       .range = complete.stream_.range(),
                       .rates = complete.stream_.rates(),
                       .held = complete.stream_.held(),
                       .steepest = complete.steepest_,
                       .seconds = complete.seconds_,
                       .segments = complete.hypotheses_.count(),
                       .rejected = complete.rejected_,
                       .car = complete.stream_.car_curves(),
                       .evidence = complete.stream_.evidence()};
  learned.known.until = clock_.stamp(learned.known.until);
  const double spacing = complete.stream_.wheel_interval();
  learned.known.motion = supported(learned.known.motion, spacing, learned.segments);
  learned.known.slip = supported(learned.known.slip, spacing, learned.segments);
  for (const HorizonErrors& errors : complete.errors_) {
    learned.students.push_back(errors.nominal(learned.known.motion->structure));
  }
  return learned;
}

std::optional<ActuatorLimits> MotionLearner::find_limits(double wheel_separation) const {
  const MotionLearner complete = completed();
  const auto cascaded = complete.hypotheses_.of(Structure::Cascaded);
  const std::vector<DrivenSegment> segments(complete.command_segments_.begin(), complete.command_segments_.end());
  if (cascaded == nullptr) {
    const std::vector<WheelSegment> twists(complete.twist_segments_.begin(), complete.twist_segments_.end());
    return find_pose_limits({.twists = twists,
                             .segments = segments,
                             .kept = *complete.known_.back().motion,
                             .settings = settings_.hypotheses,
                             .wheel_separation = wheel_separation});
  }
  const std::vector<WheelSegment> wheels(complete.wheel_segments_.begin(), complete.wheel_segments_.end());
  return find_actuator_limits({.wheels = wheels,
                               .segments = segments,
                               .cascaded = *cascaded,
                               .kept = *complete.known_.back().motion,
                               .filter = settings_.hypotheses.filter,
                               .wheel_separation = wheel_separation});
}

}  // namespace slipwise
