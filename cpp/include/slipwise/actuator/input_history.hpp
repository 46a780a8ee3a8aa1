// SPDX-License-Identifier: Apache-2.0
// What the robot was commanded (or its wheels did) over time: each sample is held until the next one.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// Sample-and-hold inputs. Before the first sample the robot is taken to be at rest. Copies share their samples, which
/// never change.
class InputHistory {
 public:
  /// No samples: at rest.
  InputHistory();
  /// Equal lengths, strictly increasing finite times [s]. \throws std::invalid_argument otherwise.
  InputHistory(std::span<const double> t, std::span<const double> v, std::span<const double> vy,
               std::span<const double> omega);
  /// The same, taken over. \throws std::invalid_argument as above.
  InputHistory(std::vector<double> t, std::vector<BodyTwist> twist);

  std::size_t size() const { return samples_->t.size(); }
  double time(std::size_t i) const { return samples_->t[i]; }
  BodyTwist sample(std::size_t i) const { return samples_->twist[i]; }
  /// The number of samples with time <= t: sample (count - 1) is the one held at t.
  std::size_t count_until(double t) const;
  /// The twist held at time t [s].
  BodyTwist at(double t) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.samples_);
    self.check_samples();
  }

 private:
  struct Samples {
    std::vector<double> t;
    std::vector<BodyTwist> twist;
  };
  /// \throws std::invalid_argument unless there is a twist at each time, and times increase.
  void check_samples() const;

  std::shared_ptr<const Samples> samples_;
};

}  // namespace slipwise
