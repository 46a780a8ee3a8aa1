// SPDX-License-Identifier: Apache-2.0
// What has to hold of streams and sources that are loaded.
#include <algorithm>
#include <cmath>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/same.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/online/known_sources.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

using archive::require;

bool goes_forward(const auto& all, auto stamp) { return std::ranges::is_sorted(all, {}, stamp); }

}  // namespace

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
                         w.start_yaw + forward + sideways + rotation + known + w.wheels.forward + w.wheels.sideways +
                         w.wheels.rotation + w.wheels.known);
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
  require(goes_forward(yaw_rates_, &YawRate::t) &&
              (!second_ || (!yaw_rates_.empty() && std::isfinite(*second_) && yaw_rates_.front().t <= *second_)),
          "turns are compared before there are any");
}

void SegmentStream::check_loaded(const SegmentStream& made) const {
  require(archive::same(settings_, made.settings_) && archive::same(keep_, made.keep_) &&
              targets_.size() == made.targets_.size() && others_.size() == made.others_.size() &&
              car_.has_value() == made.car_.has_value(),
          "a stream is of other settings");
  commands_.check_loaded(made.commands_);
  wheels_.check_loaded(made.wheels_);
  gate_.check_loaded();
  learned_.check_loaded(made.learned_);
  slip_.check_loaded(made.slip_);
  wheel_cutter_.check_loaded(made.wheel_cutter_);
  twists_.check_loaded(made.twists_);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    targets_[i].check_loaded(made.targets_[i]);
  }
  for (std::size_t i = 0; i < others_.size(); ++i) {
    require(archive::same(others_[i].settings, made.others_[i].settings), "a source is of other settings");
    others_[i].cutter.check_loaded(made.others_[i].cutter);
    others_[i].gate.check_loaded();
  }
  if (car_) {
    car_->check_loaded(present(made.car_));
  }
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
