// SPDX-License-Identifier: Apache-2.0
// Names the surface while a robot drives: takes samples of an IMU and of motor currents as they come, and answers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "slipwise/terrain/current_features.hpp"
#include "slipwise/terrain/even_samples.hpp"
#include "slipwise/terrain/terrain_classifier.hpp"
#include "slipwise/terrain/vibration_features.hpp"

namespace slipwise {

/// What one window says.
struct TimedAnswer {
  double start;  ///< [s]
  double end;    ///< [s]
  TerrainAnswer answer;
};

/// Windows begin with the first sample, and every `step` after it. One is answered once all streams that were ever
/// pushed have passed its end, or one of them is half a second behind. Memory is bounded.
class TerrainWatch {
 public:
  /// \throws std::invalid_argument when the window or the step is not positive and finite.
  TerrainWatch(TerrainClassifier classifier, const TerrainCutting& cutting, double step);

  /// Rates [rad/s] and accelerations [m/s^2] in the order of `kImuAxes`. What is not finite, or does not go on in time,
  /// is left out and counted.
  void push_imu(double t, const std::array<double, kImuAxes>& sample);
  /// Left and right current [A], left and right wheel speed [m/s]; the same.
  void push_drive(double t, const std::array<double, kDriveColumns>& sample);
  /// What windows said since the last call; those without a usable measurement say nothing.
  std::vector<TimedAnswer> take_answers();
  std::size_t left_out() const { return left_out_; }
  const TerrainCutting& cutting() const { return cutting_; }

 private:
  template <std::size_t kColumns>
  struct Stream {
    std::deque<std::pair<double, std::array<double, kColumns>>> samples;

    double newest() const { return samples.empty() ? -std::numeric_limits<double>::infinity() : samples.back().first; }
  };

  template <std::size_t kColumns>
  void push(Stream<kColumns>& stream, double t, const std::array<double, kColumns>& sample);
  template <std::size_t kColumns>
  std::optional<Eigen::MatrixXd> window_of(const Stream<kColumns>& stream, double rate) const;
  template <std::size_t kColumns>
  static void forget_before(Stream<kColumns>& stream, double t);
  void answer_window();
  bool complete(double end) const;
  double newest() const;

  TerrainClassifier classifier_;
  TerrainCutting cutting_;
  double step_;
  VibrationBands bands_;
  Stream<kImuAxes> imu_;
  Stream<kDriveColumns> drive_;
  bool begun_ = false;  ///< whether there was a sample
  double start_ = 0.0;  ///< of the next window [s]
  std::vector<TimedAnswer> answers_;
  std::size_t left_out_ = 0;
};

}  // namespace slipwise
