// SPDX-License-Identifier: Apache-2.0
// What tells surfaces apart: kernel ridge regression on vibration, and trees on motor currents. Fitted elsewhere.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace slipwise {

/// Squared distances between rows, [N, M], of [N, D] and [M, D].
Eigen::MatrixXd squared_distances(const Eigen::Ref<const Eigen::MatrixXd>& first,
                                  const Eigen::Ref<const Eigen::MatrixXd>& second);

/// Weights of a Gaussian kernel around the windows that were learned: regression on the indicators of the surfaces.
class KernelExpert {
 public:
  KernelExpert() = default;
  /// `mean` and `scale` [D] standardise features; `width` is gamma of exp(-gamma |z - z'|^2) about the `centres`
  /// [N, D] of standardised features, whose `weights` are [N, K].
  /// \throws std::invalid_argument when sizes do not fit each other, a scale is not positive, or there are too few
  /// centres.
  KernelExpert(Eigen::VectorXd mean, Eigen::VectorXd scale, double width, Eigen::MatrixXd centres,
               Eigen::MatrixXd weights);

  Eigen::Index features() const { return mean_.size(); }
  Eigen::Index surfaces() const { return weights_.cols(); }
  /// Probability of each surface [M, K] for features [M, D]; not calibrated.
  Eigen::MatrixXd probabilities(const Eigen::Ref<const Eigen::MatrixXd>& features) const;
  /// Log of the mean squared distance to the nearest windows of training, [M].
  Eigen::VectorXd newness(const Eigen::Ref<const Eigen::MatrixXd>& features) const;

 private:
  Eigen::MatrixXd distances(const Eigen::Ref<const Eigen::MatrixXd>& features) const;

  Eigen::VectorXd mean_, scale_;
  double width_ = 1.0;
  Eigen::MatrixXd centres_, weights_;
};

/// A binary tree; node 0 is the root.
struct TerrainTree {
  std::vector<int> feature;       ///< [nodes] the column that is compared, or -1 at a leaf
  std::vector<double> threshold;  ///< [nodes] to the left where the feature is at most this
  std::vector<int> left;          ///< [nodes] next one; of a leaf its row in `leaves`
  std::vector<int> right;         ///< [nodes]
  Eigen::MatrixXd leaves;         ///< [leaves, K] share of each surface
};

/// The mean of several trees.
class TreeExpert {
 public:
  TreeExpert() = default;
  /// \throws std::invalid_argument when there is no tree, or one leads nowhere, in a circle, or to a feature that is
  /// not among `features`.
  TreeExpert(std::vector<TerrainTree> trees, Eigen::Index features);

  Eigen::Index features() const { return features_; }
  Eigen::Index surfaces() const { return trees_.empty() ? 0 : trees_.front().leaves.cols(); }
  /// Probability of each surface [M, K] for features [M, D]; not calibrated.
  /// \throws std::invalid_argument when there are other features than the trees look at.
  Eigen::MatrixXd probabilities(const Eigen::Ref<const Eigen::MatrixXd>& features) const;

 private:
  std::vector<TerrainTree> trees_;
  Eigen::Index features_ = 0;
};

}  // namespace slipwise
