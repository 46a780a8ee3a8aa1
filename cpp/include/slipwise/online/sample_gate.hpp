// SPDX-License-Identifier: Apache-2.0
// Checks the samples of one stream as they come: stamps that go forward, numbers that can be.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "slipwise/online/rejection.hpp"

namespace slipwise {

inline constexpr double kLatestStamp = 4294967296.0;  ///< [s] the year 2106; what is later is no time in seconds
inline constexpr double kLargestNumber = 1e30;        ///< no measurement in SI units is larger

/// The stamps of one stream, which must go forward.
class StampGate {
 public:
  /// Why a sample with these numbers is rejected, if it is; else its stamp is the latest from now on.
  std::optional<Reason> check(double t, std::span<const double> numbers);
  double latest() const { return latest_; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.latest_);
  }

 private:
  double latest_ = -std::numeric_limits<double>::infinity();
};

/// Speeds that no ground robot can have, judged by the samples before them alone: more than 20 m/s or rad/s, more than
/// fifteen times the fastest that was accepted, and either above 100 or alone. Wheels do not step as commands may: for
/// them 5 stands in the place of 20, after the first sample.
class SpeedGate {
 public:
  /// Whether the speed [m/s or rad/s] is accepted: of wheels that are `measured`, or commanded.
  bool plausible(double value, bool measured = false);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.before_, self.fastest_);
  }

 private:
  double before_ = 0.0;    ///< the last one, accepted or not
  double fastest_ = -1.0;  ///< that was accepted; negative: none yet; the first counts where the next confirms it
};

}  // namespace slipwise
