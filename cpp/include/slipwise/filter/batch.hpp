// SPDX-License-Identifier: Apache-2.0
// The MAP estimate over all segments at once, with a Huber loss.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/filter/estimate.hpp"
#include "slipwise/linear/gauss_newton.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

struct BatchSettings {
  int iterations = 30;      ///< at most
  double tolerance = 1e-8;  ///< relative decrease of the cost that counts as converged [-]
  double huber = 2.5;       ///< a residual of more than this many sigma counts for less [-]
  /// A segment that is as good as straight along a step is not linearised again.
  bool carry = false;
  /// Where the search starts [parameters]; empty: at the prior's mean.
  Eigen::VectorXd start = {};
};

/// A segment, the inputs that it belongs to, and the covariance R of its measured chart.
struct BatchDatum {
  InputHistory inputs;
  Segment segment;
  RowsCovariance noise;
  /// Covariance of its error with that of the datum before; empty where they share nothing.
  RowsCovariance shared = {};
};

struct BatchFit {
  Estimate estimate;
  double cost;     ///< robust MAP cost at the estimate
  int iterations;  ///< used
  Status status;
  std::vector<SegmentLinearization> at;  ///< the data, at the estimate
};

/// The robust MAP problem at one point.
struct BatchPoint {
  NormalEquations equations;
  double cost;
  std::vector<SegmentLinearization> at;  ///< the data
};

/// What is new in the error of a datum, given that of the one before: a block of the Cholesky factor of all errors.
struct NewError {
  RowsCovariance by_before;          ///< of what was new in the one before, how much comes again
  Eigen::LLT<RowsCovariance> noise;  ///< of what is new
};

/// The search for the fit in slices of bounded work, so that it can run beside something that must not wait.
class BatchSearch {
 public:
  BatchSearch() = default;  ///< nothing to do
  /// `at_start` are the data at the search's start, where they were linearised there before.
  /// \throws std::invalid_argument when sizes do not fit or there is no datum.
  BatchSearch(MotionModel model, Estimate prior, std::vector<BatchDatum> data, const BatchSettings& settings,
              std::vector<SegmentLinearization> at_start = {});

  /// Linearises `segments` data at most; whether there is more to do.
  bool advance(std::size_t segments);
  /// What was found; the search must be over.
  BatchFit result() &&;
  const std::vector<BatchDatum>& data() const { return data_; }
  /// \throws std::invalid_argument where a loaded one is not a search of the model over so many data.
  void check_loaded(const MotionModel& model, std::size_t data) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.prior_, self.data_, self.prior_information_, self.search_, self.at_, self.huber_, self.carry_,
      self.best_);
    if constexpr (!std::is_const_v<Self>) {
      self.check_data();
    }
  }

 private:
  /// Finds what the data share, which is not saved. \throws std::invalid_argument when sizes do not fit, there is no
  /// datum, or a noise is none.
  void check_data();
  BatchPoint point(std::vector<SegmentLinearization> at) const;
  /// The datum at the candidate.
  SegmentLinearization linearised(std::size_t datum) const;
  void judge(BatchPoint point);

  MotionModel model_;
  Estimate prior_;
  std::vector<BatchDatum> data_;
  double huber_ = 0.0;
  bool carry_ = false;
  std::vector<NewError> errors_;
  Eigen::MatrixXd prior_information_;
  GaussNewton search_;
  std::vector<SegmentLinearization> at_;  ///< the first data, at the candidate
  std::optional<BatchPoint> best_;        ///< nothing before the start is linearised
};

/// The same at once.
/// \throws std::invalid_argument when sizes do not fit or there is no datum.
BatchFit batch_fit(const MotionModel& model, const Estimate& prior, std::vector<BatchDatum> data,
                   const BatchSettings& settings = {}, std::vector<SegmentLinearization> at_start = {});

}  // namespace slipwise
