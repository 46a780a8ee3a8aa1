// SPDX-License-Identifier: Apache-2.0
// Keeps one window of samples, and classifies it when it is complete.
#include "slipwise/terrain/terrain_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

constexpr double kLongestWait = 0.5;        // [s] for a stream that is behind another
constexpr double kLongestSilence = 60.0;    // [s] without samples; windows begin again after it
constexpr double kSameRate = 1.25;          // rates that differ by less are one
constexpr std::size_t kMostAnswers = 1000;  // that wait for a call

/// Whether samples come as often as in training.
template <class Samples>
bool same_rate(const Samples& samples, double rate) {
  std::vector<double> spacing;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    spacing.push_back(samples[i].first - samples[i - 1].first);
  }
  if (spacing.empty()) {
    return false;
  }
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  const double own = 1.0 / *middle;
  return own > rate / kSameRate && own < rate * kSameRate;
}

}  // namespace

TerrainWatch::TerrainWatch(TerrainClassifier classifier, const TerrainCutting& cutting, double step)
    : classifier_(std::move(classifier)), cutting_(cutting), step_(step), bands_(cutting.imu_rate) {
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!positive(cutting.seconds) || !positive(step)) {
    throw std::invalid_argument("windows of terrain and the time between them must be positive and finite");
  }
}

template <std::size_t kColumns>
void TerrainWatch::push(Stream<kColumns>& stream, double t, const std::array<double, kColumns>& sample) {
  const bool finite =
      std::isfinite(t) && std::ranges::all_of(sample, [](double value) { return std::isfinite(value); });
  if (!finite || (!stream.samples.empty() && t <= stream.newest())) {
    ++left_out_;
    return;
  }
  if (!begun_ || t - newest() > kLongestSilence) {
    imu_.samples.clear();
    drive_.samples.clear();
    start_ = t;
    begun_ = true;
  }
  stream.samples.emplace_back(t, sample);
  while (complete(start_ + cutting_.seconds)) {
    answer_window();
  }
}

void TerrainWatch::push_imu(double t, const std::array<double, kImuAxes>& sample) { push(imu_, t, sample); }

void TerrainWatch::push_drive(double t, const std::array<double, kDriveColumns>& sample) { push(drive_, t, sample); }

double TerrainWatch::newest() const { return std::max(imu_.newest(), drive_.newest()); }

bool TerrainWatch::complete(double end) const {
  const bool both = !imu_.samples.empty() && !drive_.samples.empty();
  const double behind = both ? std::min(imu_.newest(), drive_.newest()) : newest();
  return newest() >= end && (behind >= end || newest() >= end + kLongestWait);
}

template <std::size_t kColumns>
std::optional<Eigen::MatrixXd> TerrainWatch::window_of(const Stream<kColumns>& stream, double rate) const {
  const auto count = std::ssize(stream.samples);
  if (!(rate > 0.0) || !same_rate(stream.samples, rate)) {
    return std::nullopt;
  }
  Eigen::VectorXd times(count);
  SampleRows values(count, static_cast<Eigen::Index>(kColumns));
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [t, sample] = stream.samples[static_cast<std::size_t>(i)];
    times[i] = t;
    values.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, static_cast<int>(kColumns)>>(sample.data());
  }
  return even_samples(times, values, start_, {cutting_.seconds, rate});
}

template <std::size_t kColumns>
void TerrainWatch::forget_before(Stream<kColumns>& stream, double t) {
  while (stream.samples.size() > 1 && stream.samples[1].first <= t) {
    stream.samples.pop_front();
  }
}

void TerrainWatch::answer_window() {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd vibration = Eigen::VectorXd::Constant(kImuAxes * std::ssize(bands_.edges()), nothing);
  Eigen::VectorXd current = Eigen::VectorXd::Constant(kCurrentFeatures, nothing);
  if (const auto samples = window_of(imu_, cutting_.imu_rate)) {
    vibration = bands_.features(*samples);
  }
  if (const auto samples = window_of(drive_, cutting_.drive_rate)) {
    current = current_features(*samples);
  }
  if (auto answer = classifier_.answer(vibration, current)) {
    answers_.push_back({start_, start_ + cutting_.seconds, std::move(*answer)});
  }
  if (answers_.size() > kMostAnswers) {
    answers_.erase(answers_.begin());
  }
  start_ += step_;
  forget_before(imu_, start_);
  forget_before(drive_, start_);
}

std::vector<TimedAnswer> TerrainWatch::take_answers() { return std::exchange(answers_, {}); }

}  // namespace slipwise
