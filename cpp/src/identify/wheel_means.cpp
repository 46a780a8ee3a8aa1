// SPDX-License-Identifier: Apache-2.0
// One walk over the samples of a stretch.
#include "slipwise/identify/wheel_means.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

/// Sums what is held until an interval is closed.
class Mean {
 public:
  Mean(double start, const BodyTwist& held) : means_{.edges = {start}, .samples = {}, .twist = {}}, held_(held) {}

  double lasted(double now) const { return now - means_.edges.back(); }
  void hold(double now, const BodyTwist& next) {
    add(now);
    held_ = next;
    samples_ += 1.0;
  }
  void close(double now) {
    add(now);
    const double duration = lasted(now);
    means_.twist.push_back({sum_.v / duration, sum_.vy / duration, sum_.omega / duration});
    means_.samples.push_back(std::max(samples_, 1.0));
    means_.edges.push_back(now);
    sum_ = {};
    samples_ = 0.0;
  }
  WheelMeans result() && { return std::move(means_); }

 private:
  void add(double now) {
    const double duration = now - added_until_;
    sum_.v += held_.v * duration;
    sum_.vy += held_.vy * duration;
    sum_.omega += held_.omega * duration;
    added_until_ = now;
  }

  WheelMeans means_;
  BodyTwist held_;
  BodyTwist sum_ = {};
  double samples_ = 1.0;
  double added_until_ = means_.edges.back();
};

}  // namespace

WheelMeans wheel_means(const InputHistory& wheels, double start, double end, double shortest) {
  if (!(end > start)) {
    throw std::invalid_argument("wheel speeds are averaged from a start to a later end, got " + std::to_string(start) +
                                " s and " + std::to_string(end) + " s");
  }
  Mean mean(start, wheels.at(start + kSameStamp));
  for (std::size_t i = wheels.count_until(start + kSameStamp); i < wheels.size() && later(end, wheels.time(i)); ++i) {
    const double now = wheels.time(i);
    if (!later(shortest, mean.lasted(now)) && !later(0.5 * shortest, end - now)) {
      mean.close(now);
    }
    mean.hold(now, wheels.sample(i));
  }
  mean.close(end);
  return std::move(mean).result();
}

}  // namespace slipwise
