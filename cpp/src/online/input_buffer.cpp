// SPDX-License-Identifier: Apache-2.0
// Samples of an input, and what holds between them.
#include "slipwise/online/input_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kLeadIn = 1.0;   // [s] before the first wheel speed; no clock offset is larger
constexpr double kStep = 0.1;     // [s] an actuator with a lag is integrated in steps of no more: repeats cost time
constexpr double kLongAgo = 1e5;  // [s] a drivetrain has forgotten what came before

/// Inputs without those that repeat the one before, but for one in each `kStep`.
class Thinned {
 public:
  void add(const InputSample& sample) {
    const bool repeats = !t_.empty() && sample.twist == twist_.back();
    if (!repeats) {
      since_ = sample.t;
      step_ = 0.0;
    }
    const double step = std::floor((sample.t - since_ + kSameStamp) / kStep);
    if (!repeats || step != step_) {
      append(sample);
    }
    step_ = step;
  }
  void append(const InputSample& sample) {
    t_.push_back(sample.t);
    twist_.push_back(sample.twist);
  }
  InputHistory inputs() && { return {std::move(t_), std::move(twist_)}; }

 private:
  std::vector<double> t_;
  std::vector<BodyTwist> twist_;
  double since_ = 0.0;
  double step_ = 0.0;
};

double speed(const BodyTwist& twist) { return std::hypot(twist.v, twist.vy); }

/// From when on a sample stands for the time nearest to its stamp.
double measured_since_of(const std::deque<InputSample>& samples, std::size_t i) {
  return i == 0 ? samples.front().t : std::midpoint(samples[i - 1].t, samples[i].t);
}

}  // namespace

void InputBuffer::push(const InputSample& sample) {
  if (samples_.empty()) {
    first_ = sample.t;
  }
  const BodyTwist before = fastest_.empty() ? BodyTwist{} : fastest_.back();
  samples_.push_back(sample);
  fastest_.push_back({.v = std::max(before.v, speed(sample.twist)),
                      .vy = 0.0,
                      .omega = std::max(before.omega, std::abs(sample.twist.omega))});
}

void InputBuffer::clear() { *this = InputBuffer(unknown_after_); }

void InputBuffer::drop_before(double t) {
  while (samples_.size() > 1 && samples_[1].t <= t) {
    samples_.pop_front();
    fastest_.pop_front();
  }
}

BodyTwist InputBuffer::fastest_until(double t) const {
  const std::size_t count = count_until(t);
  return count == 0 ? BodyTwist{} : fastest_[count - 1];
}

std::size_t InputBuffer::count_until(double t) const {
  const auto after = std::ranges::upper_bound(samples_, t + kSameStamp, {}, &InputSample::t);
  return static_cast<std::size_t>(std::distance(samples_.begin(), after));
}

double InputBuffer::measured_since(double t) const { return measured_since_of(samples_, count_until(t) - 1); }

std::optional<BodyTwist> InputBuffer::held_at(double t) const {
  const std::size_t count = count_until(t);
  return count == 0 ? std::nullopt : std::optional(samples_[count - 1].twist);
}

std::optional<BodyTwist> InputBuffer::known_at(double t) const {
  const std::size_t count = count_until(t);
  const bool known = count > 0 && !later(t, samples_[count - 1].t + unknown_after_);
  return known ? std::optional(samples_[count - 1].twist) : std::nullopt;
}

std::optional<double> InputBuffer::unknown_since(double start, double end) const {
  std::size_t next = count_until(start);
  if (next == 0) {
    return start;
  }
  for (; next <= samples_.size(); ++next) {
    const double until = samples_[next - 1].t + unknown_after_;
    const bool resumed = next < samples_.size() && !later(samples_[next].t, until);
    if (!resumed && later(end, until)) {
      return std::max(until, start);
    }
    if (next == samples_.size() || !later(end, samples_[next].t)) {
      break;
    }
  }
  return std::nullopt;
}

std::optional<double> InputBuffer::first_after(double t) const {
  const std::size_t count = count_until(t);
  return count < samples_.size() ? std::optional(samples_[count].t) : std::nullopt;
}

BodyTwist InputBuffer::fastest(double start, double end) const {
  BodyTwist most{};
  for (std::size_t i = std::max<std::size_t>(count_until(start), 1) - 1;
       i < samples_.size() && later(end, samples_[i].t); ++i) {
    most.v = std::max(most.v, speed(samples_[i].twist));
    most.omega = std::max(most.omega, std::abs(samples_[i].twist.omega));
  }
  return most;
}

InputBuffer::Driven InputBuffer::driven(double start, double end) const {
  Driven sum{0.0, 0.0, 0.0};
  for (std::size_t i = std::max<std::size_t>(count_until(start), 1) - 1; i < samples_.size() && samples_[i].t < end;
       ++i) {
    const double next = i + 1 < samples_.size() ? samples_[i + 1].t : end;
    const double until = std::min({next, samples_[i].t + unknown_after_, end});
    const double seconds = std::max(until - std::max(samples_[i].t, start), 0.0);
    sum.distance += seconds * speed(samples_[i].twist);
    sum.angle += seconds * std::abs(samples_[i].twist.omega);
    sum.known += seconds;
  }
  return sum;
}

HeldMotion InputBuffer::held_motion(double start, double end) const {
  HeldMotion sum{0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = std::max<std::size_t>(count_until(start), 1) - 1; i < samples_.size() && samples_[i].t < end;
       ++i) {
    const double next = i + 1 < samples_.size() ? samples_[i + 1].t : end;
    const double until = std::min({next, samples_[i].t + unknown_after_, end});
    const double seconds = std::max(until - std::max(samples_[i].t, start), 0.0);
    sum.forward += seconds * samples_[i].twist.v;
    sum.sideways += seconds * samples_[i].twist.vy;
    sum.rotation += seconds * samples_[i].twist.omega;
    sum.known += seconds;
  }
  return sum;
}

std::vector<InputSample> InputBuffer::held(double start, double end) const {
  std::vector<InputSample> found;
  for (std::size_t i = std::max<std::size_t>(count_until(start), 1) - 1; i < samples_.size() && samples_[i].t < end;
       ++i) {
    found.push_back({std::max(samples_[i].t, start), samples_[i].twist});
  }
  return found;
}

Pose2 InputBuffer::reckoned(double start, double end) const {
  const std::vector<InputSample> pieces = held(start, end);
  Pose2 pose;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const double until = i + 1 < pieces.size() ? pieces[i + 1].t : end;
    const auto& [v, vy, omega] = pieces[i].twist;
    pose = compose(pose, exp(Eigen::Vector3d(v, vy, omega) * (until - pieces[i].t)));
  }
  return pose;
}

InputHistory InputBuffer::slice(double start, double end, SliceKind kind,
                                const std::vector<InputSample>& future) const {
  Thinned thinned;
  const auto add = [&](const InputSample& sample) {
    if (kind == SliceKind::Commands) {
      thinned.add(sample);
    } else {
      thinned.append(sample);
    }
  };
  const std::size_t from = std::max<std::size_t>(count_until(start), 1) - 1;
  if (kind != SliceKind::Commands && from < samples_.size() && samples_[from].t == first_) {
    thinned.append({first_ - kLeadIn, samples_[from].twist});
  }
  for (std::size_t i = from; i < samples_.size() && !later(samples_[i].t, end); ++i) {
    InputSample sample = samples_[i];
    if (i == from) {
      sample.t -= sample.t > first_ ? kLongAgo : 0.0;
    } else if (kind == SliceKind::Measured) {
      sample.t = measured_since_of(samples_, i);
    }
    add(sample);
  }
  for (const InputSample& sample : future) {
    if (later(sample.t, samples_.empty() ? -std::numeric_limits<double>::infinity() : newest()) &&
        !later(sample.t, end)) {
      add(sample);
    }
  }
  return std::move(thinned).inputs();
}

}  // namespace slipwise
