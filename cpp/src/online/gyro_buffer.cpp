// SPDX-License-Identifier: Apache-2.0
// Integrals of yaw rates, and a filter of one state for the bias.
#include "slipwise/online/gyro_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kStillTime, 1.0);   // [s] of standing still whose mean is a measured bias,
SLIPWISE_TUNING(kCalm, 0.5);        // [s] after the inputs stopped and before they start
SLIPWISE_TUNING(kStillStd, 2e-3);   // [rad/s] of that mean
SLIPWISE_TUNING(kBiasTime, 20.0);   // [s] over which turns of the course measure the bias,
SLIPWISE_TUNING(kCourseStd, 0.15);  // [rad] such a turn, the change of the side-slip angle included
SLIPWISE_TUNING(kDrift, 1e-4);      // [rad/s] per root of a second
SLIPWISE_TUNING(kWalk, 3e-3);       // [rad] per root of a second: noise of the gyro
SLIPWISE_TUNING(kScale, 5e-3);      // of the turn: the gyro's scale
SLIPWISE_TUNING(kPiece, 2.5);       // [s] about so long are the pieces of a segment whose turns are learned from

double squared(double value) { return value * value; }

}  // namespace

double GyroBuffer::bias_std() const { return std::sqrt(variance_); }

void GyroBuffer::learn_bias(double measured, double variance) {
  using Scalar = Eigen::Matrix<double, 1, 1>;
  Scalar known(variance_);
  bias_ += linear_update(known, Scalar::Identity(), Scalar(variance)).value() * (measured - bias_);
  variance_ = known.value();
}

void GyroBuffer::see_inputs(double t, const InputBuffer& inputs, double still_speed) {
  if (!seen_until_ || later(t, *seen_until_ + kBiasTime)) {
    seen_until_ = t;
    return;
  }
  while (!later(present(seen_until_) + kStillTime + kCalm, t)) {
    const double begin = present(seen_until_);
    seen_until_ = begin + kStillTime;
    variance_ += squared(kDrift) * kStillTime;
    const auto turned = integral(samples_, begin, begin + kStillTime);
    const double from = begin - kCalm;
    const double until = begin + kStillTime + kCalm;
    if (!turned || inputs.empty() || inputs.unknown_since(from, until)) {
      continue;
    }
    const BodyTwist fastest = inputs.fastest(from, until);
    if (std::max(fastest.v, fastest.omega) <= still_speed) {
      learn_bias(*turned / kStillTime, squared(kStillStd));
    }
  }
}

void GyroBuffer::see_course(const MeasuredPose& position) {
  if (!course_ || course_->frame != position.frame) {
    course_ = position;
    return;
  }
  const double seconds = position.t - course_->t;
  if (later(kBiasTime, seconds)) {
    return;
  }
  if (const auto turned = integral(samples_, course_->t, position.t)) {
    const double apart = wrap_angle(*turned - bias_ * seconds - (position.yaw - course_->yaw));
    learn_bias(bias_ + apart / seconds, squared(kCourseStd / seconds));
  }
  course_ = position;
}

std::optional<GyroTurn> GyroBuffer::turn(double start, double end) const {
  const auto whole = turns(start, end, 1);
  if (!whole) {
    return std::nullopt;
  }
  return GyroTurn{.angle = whole->z[0], .std = std::sqrt(std::get<YawRateSensor>(whole->sensor.kind).covariance(0, 0))};
}

/// The bias and the scale are off by the same in all pieces.
std::optional<Measured> GyroBuffer::turns(double start, double end, Eigen::Index pieces) const {
  const double seconds = (end - start) / static_cast<double>(pieces);
  Rows angles(pieces);
  for (Eigen::Index i = 0; i < pieces; ++i) {
    const double from = start + seconds * static_cast<double>(i);
    const auto turned = integral(samples_, from, i + 1 == pieces ? end : from + seconds);
    if (!turned) {
      return std::nullopt;
    }
    angles[i] = *turned - bias_ * seconds;
  }
  RowsCovariance covariance = squared(kScale) * angles * angles.transpose();
  covariance.array() += variance_ * squared(seconds);
  covariance.diagonal().array() += squared(kWalk) * seconds;
  return Measured{.sensor = {.kind = YawRateSensor{covariance}}, .z = angles};
}

Measured measured_turn(const GyroTurn& turn) {
  return {.sensor = {.kind = YawRateSensor{RowsCovariance::Constant(1, 1, squared(turn.std))}},
          .z = Rows::Constant(1, turn.angle)};
}

void GyroBuffer::measure(Segment& segment) const {
  auto* positions = std::get_if<PositionSensor>(&segment.measured.front().sensor.kind);
  if (positions == nullptr) {
    return;
  }
  const auto pieces = static_cast<Eigen::Index>(std::round((segment.end - segment.start) / kPiece));
  if (const auto turned = turns(segment.start, segment.end, std::clamp<Eigen::Index>(pieces, 1, kMostSensorRows))) {
    positions->turn = false;
    segment.measured.push_back(*turned);
  }
}

void GyroBuffer::restart() {
  samples_.clear();
  course_.reset();
  seen_until_.reset();
}

}  // namespace slipwise
