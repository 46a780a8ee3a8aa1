// SPDX-License-Identifier: Apache-2.0
// Predictions held against what was measured, none of which they had learned.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/disturbance/slip_disturbance.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/online/shared_list.hpp"
#include "slipwise/online/source_noise.hpp"
#include "slipwise/online/student_calibration.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// What was known at some time.
struct Knowledge {
  double until;                                   ///< stamp of what was measured last of all that was learned [s]
  std::shared_ptr<const MotionPosterior> motion;  ///< of the structure that predicts
  std::shared_ptr<const MotionPosterior> slip;    ///< of the best structure that has slip
  std::shared_ptr<const DisturbanceFilter> disturbance;  ///< how slip differs from that now and then
  std::shared_ptr<const MotionPosterior> clock = {};     ///< that says how late poses are; nothing without one
  std::shared_ptr<const SourceNoise> sources = {};       ///< how large errors of poses are; nothing of one sort alone
};

/// A prediction of one horizon, and what was measured.
struct HeldOutPrediction {
  std::size_t run;             ///< in the order in which runs were started
  std::size_t horizon;         ///< among the settings'
  double start;                ///< [s]
  double end;                  ///< [s]
  Eigen::Vector3d pose;        ///< predicted T_start_end: x, y [m], yaw [rad]
  Eigen::Matrix3d covariance;  ///< of a Student t, its inflation included
  StudentT student;            ///< from the errors of earlier predictions
  double nominal_nis;          ///< had nothing recent been known of the slip disturbance, and without inflation
  Structure structure;         ///< that predicted
  Eigen::Vector3d measured;    ///< what the poses say
  Eigen::Vector3d baseline;    ///< what the kinematic baseline predicts
  Eigen::Vector3d in_sample;   ///< the same model once it had learned the segment (thesis, Table 6.2)
  double learned_until;        ///< stamp of the last measurement that the prediction uses [s]
};

/// The last predictions of one horizon, oldest first.
using HeldOutPredictions = SharedList<HeldOutPrediction, 4096>;

/// The same numbers one kind after the other, [N] each, as statistics take them.
struct HeldOutColumns {
  template <int kColumns>
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kColumns, kColumns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
  using Numbers = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;

  /// \throws std::invalid_argument when one of the pointers is null.
  explicit HeldOutColumns(const std::vector<const HeldOutPrediction*>& predictions);
  explicit HeldOutColumns(const HeldOutPredictions& predictions);

  Numbers run;
  Numbers structure;
  Rows<1> start, end, inflation, dof, nominal_nis, learned_until;
  Rows<3> pose, measured, baseline, in_sample;
  Rows<9> covariance;  ///< row by row
};

/// The errors of one horizon: each structure's are a population of their own.
class HorizonErrors {
 public:
  /// The statistics of errors at some time.
  struct Known {
    double until;                                ///< stamp of the last error [s]
    std::array<StudentT, kStructures> students;  ///< of predictions that follow recent segments
  };

  HorizonErrors();
  /// What was known of errors at `t` [s].
  const Known& before(double t) const;
  /// Takes in an error that was known at `end` [s], by its squared lengths with and without recent segments. What was
  /// known `age` [s] before is asked for yet.
  void learn(double end, Structure structure, double squared, double nominal_squared, double age = 0.0);
  /// The Student t without recent segments, from all errors.
  StudentT nominal(Structure structure) const;
  /// Stamps begin again: all errors so far are known.
  void restart_clock();

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.known_, self.recent_, self.nominal_);
    if (self.known_.empty()) {
      slipwise::archive::refuse("malformed: errors of nothing known");
    }
  }

 private:
  std::deque<Known> known_;  ///< of late; the last is the newest
  std::array<StudentCalibration, kStructures> recent_;
  std::array<StudentCalibration, kStructures> nominal_;
};

/// Of all horizons: how large errors were, and the last predictions.
class HeldOutErrors {
 public:
  explicit HeldOutErrors(std::vector<double> horizons = {});

  /// Of the nearest horizon whose errors are known at `t` [s].
  StudentT student(double t, double horizon, Structure structure) const;
  /// Of one horizon, nothing recent being known, for each of them.
  std::vector<StudentT> nominal(Structure structure) const;
  /// What was known of the errors of one of the horizons at `t` [s].
  const HorizonErrors::Known& before(std::size_t horizon, double t) const { return errors_[horizon].before(t); }
  HorizonErrors& of(std::size_t horizon) { return errors_[horizon]; }
  void keep(std::shared_ptr<const HeldOutPrediction> prediction);
  const std::vector<HeldOutPredictions>& predictions() const { return predictions_; }
  void restart_clock();
  /// \throws std::invalid_argument where a loaded one is of other horizons.
  void check_loaded(const std::vector<double>& horizons) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.horizons_, self.errors_, self.predictions_);
  }

 private:
  std::vector<double> horizons_;  ///< [s]
  std::vector<HorizonErrors> errors_;
  std::vector<HeldOutPredictions> predictions_;
};

}  // namespace slipwise
