// SPDX-License-Identifier: Apache-2.0
// Periodograms of one second under Hann's window, which overlap by half, and their mean power in bands.
#include "slipwise/terrain/vibration_features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace slipwise {
namespace {

constexpr double kFastest = 1e4;   // [Hz]
constexpr double kSegment = 1.0;   // [s] of one periodogram
constexpr double kFloor = 1e-9;    // of power, so that a silent axis has a logarithm
constexpr double kNyquist = 1.01;  // an edge may lie so much above half of the sampling rate, which is measured

/// Of the samples that both ends touch zero at.
Eigen::RowVectorXd hann_window(Eigen::Index length) {
  Eigen::RowVectorXd window = Eigen::RowVectorXd::Ones(length);
  for (Eigen::Index n = 0; n < length && length > 1; ++n) {
    window[n] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(length - 1));
  }
  return window;
}

}  // namespace

VibrationBands::VibrationBands(double rate) {
  if (!(rate >= 0.0) || !(rate <= kFastest)) {
    throw std::invalid_argument("a sampling rate lies between 0 and 10000 Hz, got " + std::to_string(rate));
  }
  for (std::size_t i = 0; i + 1 < kBandEdges.size() && kBandEdges[i + 1] <= rate / 2.0 * kNyquist; ++i) {
    edges_.push_back({kBandEdges[i], kBandEdges[i + 1]});
  }
  length_ = static_cast<Eigen::Index>(std::nearbyint(kSegment * rate));
  if (edges_.empty()) {
    return;
  }
  const Eigen::RowVectorXd window = hann_window(length_);
  window_power_ = window.squaredNorm();
  std::vector<Eigen::Index> bins;
  for (const auto& [low, high] : edges_) {
    first_.push_back(std::ssize(bins));
    for (Eigen::Index k = 0; k <= length_ / 2; ++k) {
      const double frequency = static_cast<double>(k) * (rate / static_cast<double>(length_));
      if (frequency >= low && frequency < high) {
        bins.push_back(k);
      }
    }
    last_.push_back(std::ssize(bins));
  }
  cosine_.resize(std::ssize(bins), length_);
  sine_.resize(std::ssize(bins), length_);
  for (Eigen::Index row = 0; row < std::ssize(bins); ++row) {
    for (Eigen::Index n = 0; n < length_; ++n) {
      const auto turns = static_cast<double>((bins[static_cast<std::size_t>(row)] * n) % length_);
      const double angle = 2.0 * std::numbers::pi * turns / static_cast<double>(length_);
      cosine_(row, n) = window[n] * std::cos(angle);
      sine_(row, n) = window[n] * std::sin(angle);
    }
  }
}

Eigen::VectorXd VibrationBands::features(const Eigen::Ref<const Eigen::MatrixXd>& samples) const {
  if (samples.cols() != kImuAxes || samples.rows() < std::max<Eigen::Index>(length_, 1)) {
    throw std::invalid_argument("vibration is described by samples of six axes over a second or more, got " +
                                std::to_string(samples.rows()) + " by " + std::to_string(samples.cols()));
  }
  const auto bands = std::ssize(edges_);
  Eigen::VectorXd found(kImuAxes * bands);
  if (bands == 0) {
    return found;
  }
  const Eigen::MatrixXd centred = samples.rowwise() - samples.colwise().mean();
  Eigen::MatrixXd power = Eigen::MatrixXd::Zero(cosine_.rows(), kImuAxes);
  double count = 0.0;
  for (Eigen::Index at = 0; at + length_ <= centred.rows(); at += std::max<Eigen::Index>(length_ / 2, 1)) {
    const auto piece = centred.middleRows(at, length_);
    power += (cosine_ * piece).cwiseAbs2() + (sine_ * piece).cwiseAbs2();
    count += 1.0;
  }
  power /= count * window_power_;
  for (Eigen::Index axis = 0; axis < kImuAxes; ++axis) {
    for (Eigen::Index band = 0; band < bands; ++band) {
      const auto i = static_cast<std::size_t>(band);
      const Eigen::Index bins = last_[i] - first_[i];  // none at a rate that is far from whole: not a number then
      const double mean = power.col(axis).segment(first_[i], bins).sum() / static_cast<double>(bins);
      found[axis * bands + band] = std::log(mean + kFloor);
    }
  }
  return found;
}

}  // namespace slipwise
