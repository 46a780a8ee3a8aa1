// SPDX-License-Identifier: Apache-2.0
// Evaluates a kernel regression and trees whose numbers are given.
#include "slipwise/terrain/terrain_experts.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/linear/softmax.hpp"

namespace slipwise {
namespace {

constexpr double kSharpness = 4.0;       // of the softmax over indicators, before calibration
constexpr Eigen::Index kNearest = 5;     // windows of training whose mean distance says how new a window is
constexpr double kLeastDistance = 1e-6;  // of that distance, so that it has a logarithm

void check_columns(const Eigen::Ref<const Eigen::MatrixXd>& features, Eigen::Index expected) {
  if (features.cols() != expected) {
    throw std::invalid_argument("a window has " + std::to_string(features.cols()) + " features where " +
                                std::to_string(expected) + " were trained with");
  }
}

void check_tree(const TerrainTree& tree, Eigen::Index surfaces, Eigen::Index features) {
  const int nodes = static_cast<int>(tree.feature.size());
  const std::size_t size = tree.feature.size();
  bool sound = nodes > 0 && tree.threshold.size() == size && tree.left.size() == size && tree.right.size() == size &&
               tree.leaves.cols() == surfaces;
  for (int i = 0; sound && i < nodes; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool leaf = tree.feature[k] < 0;
    const auto onward = [&](int next) { return next > i && next < nodes; };
    sound = leaf ? tree.left[k] >= 0 && tree.left[k] < tree.leaves.rows()
                 : tree.feature[k] < features && onward(tree.left[k]) && onward(tree.right[k]);
  }
  if (!sound) {
    throw std::invalid_argument("a tree of surfaces has nodes that lead nowhere, or arrays that differ in length");
  }
}

}  // namespace

Eigen::MatrixXd squared_distances(const Eigen::Ref<const Eigen::MatrixXd>& first,
                                  const Eigen::Ref<const Eigen::MatrixXd>& second) {
  if (first.cols() != second.cols()) {
    throw std::invalid_argument("distances need rows of one length, got " + std::to_string(first.cols()) + " and " +
                                std::to_string(second.cols()));
  }
  Eigen::MatrixXd found = -2.0 * first * second.transpose();
  found.colwise() += first.rowwise().squaredNorm();
  found.rowwise() += second.rowwise().squaredNorm().transpose();
  return found.cwiseMax(0.0);
}

KernelExpert::KernelExpert(Eigen::VectorXd mean, Eigen::VectorXd scale, double width, Eigen::MatrixXd centres,
                           Eigen::MatrixXd weights)
    : mean_(std::move(mean)),
      scale_(std::move(scale)),
      width_(width),
      centres_(std::move(centres)),
      weights_(std::move(weights)) {
  if (scale_.size() != mean_.size() || centres_.cols() != mean_.size() || weights_.rows() != centres_.rows() ||
      centres_.rows() < kNearest || !(scale_.array() > 0.0).all() || !(width_ > 0.0)) {
    throw std::invalid_argument(
        "an expert of vibration has numbers that do not fit each other, a scale that is not positive, or too few "
        "centres");
  }
}

Eigen::MatrixXd KernelExpert::distances(const Eigen::Ref<const Eigen::MatrixXd>& features) const {
  check_columns(features, mean_.size());
  const Eigen::MatrixXd standardised =
      ((features.rowwise() - mean_.transpose()).array().rowwise() / scale_.transpose().array());
  return squared_distances(standardised, centres_);
}

Eigen::MatrixXd KernelExpert::probabilities(const Eigen::Ref<const Eigen::MatrixXd>& features) const {
  const Eigen::MatrixXd kernel = (-width_ * distances(features)).array().exp();
  return softmax_of_rows(kSharpness * (kernel * weights_));
}

Eigen::VectorXd KernelExpert::newness(const Eigen::Ref<const Eigen::MatrixXd>& features) const {
  const Eigen::MatrixXd all = distances(features);
  Eigen::VectorXd found(all.rows());
  for (Eigen::Index i = 0; i < all.rows(); ++i) {
    Eigen::VectorXd row = all.row(i);
    std::nth_element(row.begin(), row.begin() + (kNearest - 1), row.end());
    found[i] = std::log(row.head<kNearest>().mean() * width_ + kLeastDistance);
  }
  return found;
}

TreeExpert::TreeExpert(std::vector<TerrainTree> trees, Eigen::Index features)
    : trees_(std::move(trees)), features_(features) {
  if (trees_.empty()) {
    throw std::invalid_argument("an expert of motor currents needs a tree");
  }
  for (const TerrainTree& tree : trees_) {
    check_tree(tree, surfaces(), features_);
  }
}

Eigen::MatrixXd TreeExpert::probabilities(const Eigen::Ref<const Eigen::MatrixXd>& features) const {
  check_columns(features, features_);
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(features.rows(), surfaces());
  for (const TerrainTree& tree : trees_) {
    for (Eigen::Index row = 0; row < features.rows(); ++row) {
      std::size_t node = 0;
      while (tree.feature[node] >= 0) {
        const bool lower = features(row, tree.feature[node]) <= tree.threshold[node];
        node = static_cast<std::size_t>(lower ? tree.left[node] : tree.right[node]);
      }
      found.row(row) += tree.leaves.row(tree.left[node]);
    }
  }
  return found / static_cast<double>(trees_.size());
}

}  // namespace slipwise
