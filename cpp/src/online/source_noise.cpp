// SPDX-License-Identifier: Apache-2.0
// Means of squared errors, class by class.
#include "slipwise/online/source_noise.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/online/pose_fix.hpp"

namespace slipwise {
namespace {

constexpr int kSteady = 3;         // segments of a class that are not far larger than expected, until it teaches
constexpr double kStartingAs = 1;  // segments that what a class begins with counts as

/// Of the variances of all three directions, in one number.
double mean_of(const Eigen::Vector3d& variances) { return std::exp(variances.array().log().mean()); }

}  // namespace

SourceNoise::SourceNoise(const NoiseSettings& settings) : settings_(settings) {
  settings_.prior_segments = kStartingAs;
}

/// The numbers of the first source's classes go up with how good its fixes are.
void SourceNoise::meet(std::size_t noise_class, const Eigen::Vector3d& scale) {
  if (classes_.size() <= noise_class) {
    classes_.resize(noise_class + 1, Class{NoiseScale(settings_)});
  }
  Class& found = classes_[noise_class];
  if (found.any) {
    return;
  }
  found = {.scale = NoiseScale(settings_, scale), .any = true};
  if (noise_class < kPoseFixes && (!reference_ || noise_class > *reference_)) {
    reference_ = noise_class;
  }
}

Eigen::Vector3d SourceNoise::value(std::size_t noise_class, const Eigen::Vector3d& scale) const {
  return noise_class == reference_ || !met(noise_class) ? scale : classes_[noise_class].scale.value();
}

void SourceNoise::learn(std::size_t noise_class, const Directions& directions, const RowErrors& shown) {
  Class& found = classes_[noise_class];
  const Rows scale = found.scale.value()(directions);
  const Rows beside = shown.squared.cwiseQuotient(shown.open + scale.cwiseProduct(shown.expected));
  if (found.steady < kSteady) {
    found.steady = beside.maxCoeff() > settings_.largest ? 0 : found.steady + 1;
  }
  found.scale.learn_prediction(directions, shown);
}

bool SourceNoise::is_reference(const std::array<std::size_t, 2>& classes) const {
  return classes[0] == reference_ && classes[1] == reference_;
}

Eigen::Vector3d SourceNoise::size(const std::array<std::size_t, 2>& classes, const Eigen::Vector3d& scale) const {
  return (value(classes[0], scale) + value(classes[1], scale)) / 2.0;
}

bool SourceNoise::known(const std::array<std::size_t, 2>& classes) const {
  return std::ranges::all_of(
      classes, [&](std::size_t each) { return each == reference_ || (met(each) && classes_[each].steady >= kSteady); });
}

/// All by the same law: what the filters think of the reference follows later.
double SourceNoise::beside_best(const std::array<std::size_t, 2>& classes) const {
  const auto shown = [&](std::size_t each) {
    return met(each) ? classes_[each].scale.value() : Eigen::Vector3d(Eigen::Vector3d::Ones());
  };
  const double here = mean_of((shown(classes[0]) + shown(classes[1])) / 2.0);
  double best = here;
  for (std::size_t i = 0; i < classes_.size(); ++i) {
    if (known({i, i})) {
      best = std::min(best, mean_of(shown(i)));
    }
  }
  return std::sqrt(here / best);
}

}  // namespace slipwise
