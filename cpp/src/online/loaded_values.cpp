// SPDX-License-Identifier: Apache-2.0
// Lengths, definiteness and times of what is loaded.
#include "slipwise/online/loaded_values.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "slipwise/archive/bytes.hpp"

namespace slipwise {
namespace {

using archive::require;

constexpr double kRounding = 1e-6;   // of the largest variance: by so much a covariance may miss being one
constexpr double kLongest = 4000.0;  // [s] of a segment: more than the longest prediction
constexpr std::size_t kAxes = 3;     // of a twist
constexpr int kMostTested = 1000;    // segments in which a change is looked for
constexpr double kLargest = 1e150;   // whose square is a number still

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
         Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(twice, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() >=
             -2.0 * kRounding * largest;
}

bool are_variances(const Eigen::VectorXd& values) { return possible(values) && (values.array() >= 0.0).all(); }

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
  const auto is_near = [&](double t) { return std::abs(t - value.start) <= kLongest; };
  require(possible(value.start) && value.end > value.start && is_near(value.end), "a segment has no duration");
  require(possible(value.measured.vector()) && possible(value.sensor.vector()) && possible(value.heading) &&
              (!value.initial || possible(*value.initial)) && possible(value.gx) && possible(value.gy),
          "a segment is not finite");
  require(!value.known || (value.known->twist && is_near(value.known->until)), "the known state of a drive is missing");
  require(!value.chords || (is_near((*value.chords)[0].from) && is_near((*value.chords)[1].from)),
          "a chord begins far from its segment");
}

void LoadedValues::check(Type<SegmentPath> /*type*/, const SegmentPath& value) {
  const std::size_t steps = value.drive.size();
  const auto inside = [&](std::size_t place) { return place < value.poses.size(); };
  require((value.poses.empty() && value.times.empty()) ||
              (value.poses.size() == steps + 1 && value.times.size() == steps + 1),
          "a path has other poses than steps");
  require(value.tangents.size() == steps, "a path has other tangents than steps");
  require(!value.course || value.poses.empty() || std::ranges::all_of(value.course->at, inside),
          "a course leaves its path");
}

void LoadedValues::check(Type<SegmentLinearization> /*type*/, const SegmentLinearization& value) {
  require(possible(value.by_parameter), "a derivative is not finite");
}

void LoadedValues::check(Type<WheelSegment> /*type*/, const WheelSegment& value) {
  require(possible(value.start) && value.end > value.start && value.end - value.start <= kLongest,
          "a stretch of wheel speeds has no duration");
}

void LoadedValues::check(Type<WheelMeans> /*type*/, const WheelMeans& value) {
  require(!value.twist.empty() && value.samples.size() == value.twist.size() &&
              value.edges.size() == value.twist.size() + 1 && increases(value.edges) &&
              value.edges.back() - value.edges.front() <= kLongest,
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

void LoadedValues::check(Type<YawRate> /*type*/, const YawRate& value) {
  require(possible(value.t) && possible(value.rate), "a yaw rate is not finite");
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

void LoadedValues::check(Type<ChangeSettings> /*type*/, const ChangeSettings& value) {
  require(0 < value.shortest && value.shortest <= value.longest && value.longest <= kMostTested && 0 <= value.trial,
          "a change is tested over no segments, or too many");
}

void LoadedValues::check(Type<StreamSettings> /*type*/, const StreamSettings& value) {
  const auto is_length = [](double seconds) { return seconds > 0.0 && seconds < kLongest; };
  require(is_length(value.segment_length) && std::ranges::all_of(value.horizons, is_length) &&
              value.unknown_after >= 0.0 && value.latency >= 0.0 && value.latency < kLongest &&
              (!value.stride || is_length(*value.stride)),
          "a segment has no length");
}

}  // namespace slipwise
