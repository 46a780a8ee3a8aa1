// SPDX-License-Identifier: Apache-2.0
// For how long inputs were held: what is slower than that was never seen to its end.
#pragma once

#include <array>
#include <optional>

#include "slipwise/online/body_rates.hpp"
#include "slipwise/online/input_buffer.hpp"

namespace slipwise {

/// Takes the inputs of one run after another, and remembers in constant memory. An input is held while it stays within
/// a fifth of the fastest so far of where it was; zero tells nothing, for a dead band holds a robot there, too.
class HoldTimes {
 public:
  /// `unknown_after`: an input is unknown once it is older than this [s].
  explicit HoldTimes(double unknown_after) : unknown_after_(unknown_after) {}

  /// Takes an input, whose stamp is later than those before.
  void push(const InputSample& sample);
  /// Another run begins.
  void restart();
  /// The time for which speeds and yaw rates were held, longer than 90 % of the driving time [s]; 0 where none was.
  std::array<double, 2> found() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.unknown_after_, self.last_, self.axes_);
  }

 private:
  struct Axis {
    double value = 0.0;    ///< that is held
    double since = 0.0;    ///< [s]
    double fastest = 0.0;  ///< so far
    RobustGreatest held = {};

    void take(double input, double t, double ended);
    void end(double t);

    /// Names what is saved.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& a) {
      a(self.value, self.since, self.fastest, self.held);
    }
  };

  double unknown_after_;
  std::optional<double> last_;  ///< stamp of the newest input [s]
  std::array<Axis, 2> axes_;    ///< speed, yaw rate
};

}  // namespace slipwise
