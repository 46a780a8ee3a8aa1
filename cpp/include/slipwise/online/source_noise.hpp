// SPDX-License-Identifier: Apache-2.0
// How large the errors of each source of poses are, and of each of its fixes, beside those of the first.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "slipwise/filter/noise_scale.hpp"

namespace slipwise {

/// The filters learn how large the noise of one class is (a source and a fix): the best fix of the first source. For
/// each other class there is a mean of squared errors here. `scale` is always the filters' own, as it is now.
class SourceNoise {
 public:
  explicit SourceNoise(const NoiseSettings& settings = {});

  /// Segments of this class begin to come.
  void meet(std::size_t noise_class, const Eigen::Vector3d& scale);
  /// Learns from a segment between two poses of a class that was met.
  void learn(std::size_t noise_class, const Directions& directions, const RowErrors& shown);
  /// Whether the filters learn from it how large noise is.
  bool is_reference(const std::array<std::size_t, 2>& classes) const;
  /// Factor of the variances of (x, y, theta) that the shape expects, between poses of these classes.
  Eigen::Vector3d size(const std::array<std::size_t, 2>& classes, const Eigen::Vector3d& scale) const;
  /// Whether there was a segment of the class.
  bool met(std::size_t noise_class) const { return noise_class < classes_.size() && classes_[noise_class].any; }
  /// Whether the errors of both classes are known about: a new one first shows how large they are.
  bool known(const std::array<std::size_t, 2>& classes) const;
  /// How many times as large errors between them are as those of the best class that is known.
  double beside_best(const std::array<std::size_t, 2>& classes) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.classes_, self.reference_);
  }

 private:
  struct Class {
    NoiseScale scale;
    int steady = 0;  ///< first segments none of which was far larger than expected
    bool any = false;
  };
  Eigen::Vector3d value(std::size_t noise_class, const Eigen::Vector3d& scale) const;

  NoiseSettings settings_;
  std::vector<Class> classes_;
  std::optional<std::size_t> reference_;
};

}  // namespace slipwise
