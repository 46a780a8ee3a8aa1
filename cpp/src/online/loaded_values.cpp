// SPDX-License-Identifier: Apache-2.0
// What has to hold of what is loaded: lengths, definiteness and times of values, streams and sources.
#include "slipwise/online/loaded_values.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <variant>
#include <vector>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/same.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/online/known_sources.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

using archive::require;

constexpr double kRounding = 1e-6;          // of the largest variance: by so much a covariance may miss being one
constexpr double kLongestSegment = 4000.0;  // [s] of a segment: more than the longest prediction
constexpr std::size_t kAxes = 3;            // of a twist
constexpr double kLargest = 1e150;          // whose square is a number still

bool possible(double value) { return std::abs(value) < kLargest; }

bool possible(const BodyTwist& twist) { return possible(twist.v) && possible(twist.vy) && possible(twist.omega); }

bool possible(const Eigen::Ref<const Eigen::MatrixXd>& numbers) {
  return numbers.size() == 0 || (numbers.allFinite() && numbers.cwiseAbs().maxCoeff() < kLargest);
}

bool increases(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return possible(value); }) &&
         std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
}

bool is_covariance(const Eigen::MatrixXd& matrix) {
  if (matrix.rows() != matrix.cols() || !possible(matrix)) {
    return false;
  }
  if (matrix.size() == 0) {
    return true;
  }
  const double largest = matrix.cwiseAbs().maxCoeff();
  const Eigen::MatrixXd twice = matrix + matrix.transpose();
  return (matrix - matrix.transpose()).cwiseAbs().maxCoeff() <= kRounding * largest &&
         symmetric_eigen(twice).values.minCoeff() >= -2.0 * kRounding * largest;
}

bool are_variances(const Eigen::VectorXd& values) { return possible(values) && (values.array() >= 0.0).all(); }

bool fits_together(const PoseSensor& /*sensor*/) { return true; }

bool fits_together(const PositionSensor& sensor) {
  const Eigen::Index count = sensor.at.size();
  return count > 0 && sensor.weights.size() == count && sensor.fitted.cols() == count &&
         sensor.gain.cols() == 2 * count && possible(sensor.at) && possible(sensor.weights) &&
         sensor.weights.minCoeff() > 0.0 && possible(sensor.fitted) && possible(sensor.gain) && possible(sensor.motion);
}

bool fits_together(const YawRateSensor& sensor) {
  return 0 < sensor.covariance.rows() && sensor.covariance.rows() <= kMostSensorRows &&
         is_covariance(sensor.covariance);
}

/// Whether there are sensors, and each measured as many numbers as it has rows.
bool are_of_sensors(const std::vector<Measured>& all) {
  Eigen::Index rows = 0;
  for (const auto& [sensor, z] : all) {
    rows += z.size();
    const bool whole = std::visit([](const auto& kind) { return fits_together(kind); }, sensor.kind);
    if (!whole || z.size() != directions(sensor).size() || !possible(z) || !possible(sensor.place.vector()) ||
        !possible(sensor.clock) || !are_variances(sensor.noise_factor)) {
      return false;
    }
  }
  return 0 < rows && rows <= kMostRows;
}

bool goes_forward(const auto& all, auto stamp) { return std::ranges::is_sorted(all, {}, stamp); }

}  // namespace

void LoadedValues::check(Type<Estimate> /*type*/, const Estimate& value) {
  require(possible(value.mean), "an estimate is not finite");
  require(value.covariance.rows() == value.mean.size() && is_covariance(value.covariance),
          "the covariance of an estimate is none");
}

void LoadedValues::check(Type<NormalEquations> /*type*/, const NormalEquations& value) {
  require(
      value.information.rows() == value.gradient.size() && is_covariance(value.information) && possible(value.gradient),
      "normal equations do not fit together");
}

void LoadedValues::check(Type<MotionPosterior> /*type*/, const MotionPosterior& value) {
  const Eigen::Index size = value.model.size();
  require(value.estimate.mean.size() == size && value.prior_std.size() == size && are_variances(value.prior_std) &&
              (value.variance_ratio.size() == 0 || value.variance_ratio.size() == size) &&
              are_variances(value.noise_scale),
          "a posterior has other parameters than its model");
}

void LoadedValues::check(Type<SurfaceSlip> /*type*/, const SurfaceSlip& value) {
  const Eigen::Index slip = value.mean.size();
  require(value.covariance.rows() == slip && is_covariance(value.covariance) && value.by_robot.rows() == slip &&
              value.by_robot.cols() == value.robot.size() && value.prior_std.size() == slip && possible(value.mean) &&
              possible(value.by_robot) && possible(value.robot) && are_variances(value.prior_std),
          "the slip of a surface does not fit together");
}

void LoadedValues::check(Type<SurfaceMemory> /*type*/, const SurfaceMemory& value) {
  require(value.weights.size() == std::ssize(value.slips) && are_variances(value.weights),
          "a surface has other bases than weights");
}

void LoadedValues::check(Type<Segment> /*type*/, const Segment& value) {
  const auto is_near = [&](double t) { return std::abs(t - value.start) <= kLongestSegment; };
  require(possible(value.start) && value.end > value.start && is_near(value.end), "a segment has no duration");
  require(are_of_sensors(value.measured) && possible(value.heading) && (!value.initial || possible(*value.initial)) &&
              possible(value.gx) && possible(value.gy),
          "a segment is not finite");
  require(!value.known || (value.known->twist && is_near(value.known->until)), "the known state of a drive is missing");
  const auto [start, end] = path_span(value);
  require(is_near(start) && is_near(end), "a sensor looks far away from its segment");
}

void LoadedValues::check(Type<SegmentPath> /*type*/, const SegmentPath& value) {
  const std::size_t steps = value.drive.size();
  const auto inside = [&](std::size_t place) { return place < value.poses.size(); };
  require((value.poses.empty() && value.times.empty()) ||
              (value.poses.size() == steps + 1 && value.times.size() == steps + 1),
          "a path has other poses than steps");
  require(value.tangents.size() == steps, "a path has other tangents than steps");
  require(value.sights.size() == value.measured.size() && (value.poses.empty() || are_of_sensors(value.measured)),
          "a path has other sights than sensors");
  for (std::size_t i = 0; i < value.sights.size(); ++i) {
    const Sight& sight = value.sights[i];
    require(sight.stamps.size() == moments(value.measured[i].sensor, 0.0, 1.0).size() &&
                (value.poses.empty() || std::ranges::all_of(sight.at, inside)),
            "a sensor looks at what is not on its path");
  }
}

void LoadedValues::check(Type<SegmentLinearization> /*type*/, const SegmentLinearization& value) {
  const bool used_up = value.by_parameter.size() == 0;
  require(used_up || (possible(value.by_parameter) && value.by_parameter.rows() == value.predicted.size() &&
                      value.predicted.size() == value.path.directions().size()),
          "a derivative is not of what sensors see, or is not finite");
}

void LoadedValues::check(Type<WheelSegment> /*type*/, const WheelSegment& value) {
  require(possible(value.start) && value.end > value.start && value.end - value.start <= kLongestSegment &&
              value.known_at >= value.end && possible(value.known_at),
          "a stretch of wheel speeds has no duration");
}

void LoadedValues::check(Type<WheelMeans> /*type*/, const WheelMeans& value) {
  require(!value.twist.empty() && value.samples.size() == value.twist.size() &&
              value.edges.size() == value.twist.size() + 1 && increases(value.edges) &&
              value.edges.back() - value.edges.front() <= kLongestSegment,
          "means of wheel speeds do not fit together");
  require(std::ranges::all_of(value.samples, [](double n) { return n >= 0.0 && possible(n); }) &&
              std::ranges::all_of(value.twist, [](const BodyTwist& twist) { return possible(twist); }),
          "means of wheel speeds are not finite");
}

void LoadedValues::check(Type<ChannelRun> /*type*/, const ChannelRun& value) {
  require(std::ranges::all_of(value.live, [](std::size_t place) { return place < kAxes; }),
          "an actuator follows other axes than there are");
}

void LoadedValues::check(Type<TwistStretch> /*type*/, const TwistStretch& value) {
  require(value.t.size() == value.twist.size() && increases(value.t), "twists between poses do not fit together");
}

void LoadedValues::check(Type<MeasuredPose> /*type*/, const MeasuredPose& value) {
  require(possible(value.t) && possible(value.x) && possible(value.y) && possible(value.yaw), "a pose is not finite");
}

void LoadedValues::check(Type<InputSample> /*type*/, const InputSample& value) {
  require(possible(value.t) && possible(value.twist), "an input is not finite");
}

void LoadedValues::check(Type<TimedNumber> /*type*/, const TimedNumber& value) {
  require(possible(value.t) && possible(value.value), "a reading is not finite");
}

void LoadedValues::check(Type<MeasuredTilts> /*type*/, const MeasuredTilts& value) {
  require(std::ranges::is_sorted(value.at, {}, &Tilt::t) &&
              std::ranges::all_of(
                  value.at,
                  [](const Tilt& tilt) { return possible(tilt.t) && possible(tilt.roll) && possible(tilt.pitch); }),
          "an attitude is not finite");
}

void LoadedValues::check(Type<MappedGround> /*type*/, const MappedGround& value) {
  require(value.map != nullptr, "a map of the ground is missing");
}

void LoadedValues::check(Type<KnotCurve> /*type*/, const KnotCurve& value) {
  require(!value.at.empty() && value.value.size() == value.at.size() &&
              (value.std.empty() || value.std.size() == value.at.size()) && increases(value.at),
          "a curve's knots do not fit together");
}

void LoadedValues::check(Type<StreamSettings> /*type*/, const StreamSettings& value) {
  const auto is_length = [](double seconds) { return seconds > 0.0 && seconds < kLongestSegment; };
  require(is_length(value.segment_length) && std::ranges::all_of(value.horizons, is_length) &&
              value.unknown_after >= 0.0 && value.latency >= 0.0 && value.latency < kLongestSegment &&
              (!value.stride || is_length(*value.stride)) &&
              (!value.embargo || (*value.embargo >= 0.0 && *value.embargo < kLongestSegment)),
          "a segment has no length");
}

void InputBuffer::check_loaded(const InputBuffer& made) const {
  require(archive::same(unknown_after_, made.unknown_after_) && goes_forward(samples_, &InputSample::t),
          "inputs are not in the order of time");
}

void PoseGate::check_loaded() const {
  require(accepted_.size() <= 3 && (!given_ || !accepted_.empty()), "the frame of the last pose has no pose");
}

void SegmentCutter::check_loaded(const SegmentCutter& made) const {
  require(archive::same(length_, made.length_) && archive::same(rules_, made.rules_) &&
              whole_frames_ == made.whole_frames_ && archive::same(stride_, made.stride_) &&
              goes_forward(poses_, [](const TimedPose& timed) { return timed.pose.t; }),
          "segments are cut by other rules");
}

void PoseTwists::check_loaded(const PoseTwists& made) const {
  cutter_.check_loaded(made.cutter_);
  require(archive::same(sensor_, made.sensor_), "twists are of another sensor");
}

void CarStream::check_loaded(const CarStream& made) const {
  given_.check_loaded(made.given_);
  filter_.check_loaded(made.filter_);
  require(!known_.empty(), "nothing is known of the car");
  for (const KnownCurves& known : known_) {
    const Eigen::Index size = car_numbers(known.curves).size();
    const CarSpread* spread = known.curves.spread.get();
    require(spread == nullptr || (spread->covariance.rows() == size && spread->covariance.cols() == size &&
                                  spread->prior_std.size() == size && spread->covariance.allFinite()),
            "the covariance of the car is not that of its numbers");
  }
}

void WindowCutter::check_loaded() const {
  const auto finite = [](const MotionWindow& w) {
    const auto& [forward, sideways, rotation, known] = w.commands;
    return std::isfinite(w.start + w.since + w.duration + w.distance + w.course + w.turn + w.turn_degrees +
                         w.start_yaw + w.ahead + w.left + forward + sideways + rotation + known + w.wheels.forward +
                         w.wheels.sideways + w.wheels.rotation + w.wheels.known);
  };
  require(std::ranges::all_of(windows_, finite) && std::ranges::all_of(recent_, finite) && recent_.size() <= driven_ &&
              first_.has_value() == last_.has_value(),
          "windows of motion have numbers that none has");
}

void ProbeCutter::check_loaded() const {
  const auto forward = [](const WheelProbe& probe) { return goes_forward(probe.path, &StampedPose::t); };
  require(goes_forward(open_, &StampedPose::t) && std::ranges::all_of(probes_, forward) &&
              std::ranges::all_of(recent_, forward),
          "paths of wheels are not in the order of time");
}

void MotionEvidence::check_loaded() const {
  measured_.check_loaded();
  accepted_.check_loaded();
  probes_.check_loaded();
  require(gated_.size() == measured_.recent().size() && last_seconds_.size() <= gyro_seconds_,
          "the last windows of motion are not those that were counted");
  require(goes_forward(yaw_rates_, &TimedNumber::t) &&
              (!second_ || (!yaw_rates_.empty() && std::isfinite(*second_) && yaw_rates_.front().t <= *second_)),
          "turns are compared before there are any");
}

void MeasuredDrive::check_loaded(const MeasuredDrive& made) const {
  require(archive::same(settings, made.settings) && car.has_value() == made.car.has_value(),
          "a stream is of other settings");
  commands.check_loaded(made.commands);
  wheels.check_loaded(made.wheels);
  if (car) {
    car->check_loaded(present(made.car));
  }
}

void SegmentCutters::check_loaded(const SegmentCutters& made) const {
  require(targets_.size() == made.targets_.size(), "a stream is of other settings");
  learned_.check_loaded(made.learned_);
  slip_.check_loaded(made.slip_);
  wheels_.check_loaded(made.wheels_);
  twists_.check_loaded(made.twists_);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    targets_[i].check_loaded(made.targets_[i]);
  }
}

void PoseSources::check_loaded(const PoseSources& made) const {
  require(sources_.size() == made.sources_.size(), "a stream is of other sources");
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    require(archive::same(sources_[i].settings, made.sources_[i].settings), "a source is of other settings");
    sources_[i].cutter.check_loaded(made.sources_[i].cutter);
    sources_[i].gate.check_loaded();
  }
}

void SegmentStream::check_loaded(const SegmentStream& made) const {
  drive_.check_loaded(made.drive_);
  others_.check_loaded(made.others_);
  require(archive::same(keep_, made.keep_), "a stream is of other settings");
  gate_.check_loaded();
  cutters_.check_loaded(made.cutters_);
  evidence_.check_loaded();
  require(goes_forward(poses_, &MeasuredPose::t) && std::ranges::is_sorted(wheel_stamps_) && !std::isnan(newest_) &&
              std::ranges::none_of(wheel_stamps_, [](double t) { return !std::isfinite(t); }),
          "what waits is not in the order of time");
}

void SourceMerge::check_loaded(const SourceMerge& made) const {
  require(archive::same(longest_, made.longest_) && seen_.size() == made.seen_.size() &&
              std::ranges::all_of(waiting_, [&](const MergedSegment& each) { return each.source < seen_.size(); }),
          "a segment is of a source that is not there");
}

void KnownSources::check_loaded(const KnownSources& made) const {
  require(archive::same(settings_, made.settings_) && archive::same(filter_, made.filter_) &&
              calibrations_.size() == made.calibrations_.size() && seen_until_.size() == made.seen_until_.size() &&
              learned_.size() == made.learned_.size(),
          "sources are others than those of the settings");
  for (std::size_t i = 0; i < calibrations_.size(); ++i) {
    require(calibrations_[i].estimate().mean.size() == made.calibrations_[i].estimate().mean.size(),
            "the calibration of a source is of other parameters");
  }
  merge_.check_loaded(made.merge_);
}

}  // namespace slipwise
