// SPDX-License-Identifier: Apache-2.0
// Gauss-Newton whose steps are halved until they help, one candidate at a time: whoever has the problem evaluates it.
#pragma once

#include <Eigen/Core>
#include <limits>

namespace slipwise {

/// Of a sum of squares, or of -2 log posterior, at one point.
struct NormalEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;  ///< of half the cost, downhill
};

struct DescentSettings {
  int iterations;         ///< candidates after the start, at most
  double relative = 0.0;  ///< a decrease of the cost by this fraction of it is not worth a step [-]
  double absolute = 0.0;  ///< neither is one by this much
  double longest_step = std::numeric_limits<double>::infinity();  ///< of each parameter
};

/// `while (!search.over())`: evaluate the candidate, let its cost be judged, and propose the next from the normal
/// equations at the best point. It holds no data, so that its problem may be evaluated in slices, and saved.
class GaussNewton {
 public:
  GaussNewton() = default;  ///< nothing to do
  /// The first candidate is the start.
  GaussNewton(Eigen::VectorXd start, const DescentSettings& settings);

  const Eigen::VectorXd& candidate() const { return candidate_; }
  /// Whether the candidate, whose cost this is, is the best so far.
  bool judge(double cost);
  /// Makes the next candidate, unless none is worth it.
  void propose(const NormalEquations& at_best);

  bool over() const { return over_; }
  bool converged() const { return converged_; }  ///< not merely out of iterations
  const Eigen::VectorXd& best() const { return best_; }
  double cost() const { return cost_; }           ///< of the best
  int iterations() const { return iterations_; }  ///< candidates proposed
  /// Whether all its steps are of so many parameters, as one that was loaded has to be.
  bool has_size(Eigen::Index size) const {
    return candidate_.size() == size && best_.size() == size && (step_.size() == size || fraction_ == 1.0);
  }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.candidate_, self.best_, self.cost_, self.step_, self.fraction_, self.iterations_,
      self.begun_, self.converged_, self.over_);
  }

 private:
  double worth() const { return settings_.absolute + settings_.relative * cost_; }

  DescentSettings settings_{.iterations = 0};
  Eigen::VectorXd candidate_;
  Eigen::VectorXd best_;
  double cost_ = 0.0;
  Eigen::VectorXd step_;   ///< from the best
  double fraction_ = 1.0;  ///< of the step, at the candidate
  int iterations_ = 0;
  bool begun_ = false;
  bool converged_ = false;
  bool over_ = true;
};

}  // namespace slipwise
