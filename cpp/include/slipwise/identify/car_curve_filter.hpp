// SPDX-License-Identifier: Apache-2.0
// Learns what throttle and steering of a car do from how it moved, recursively: nothing later is used
// (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/identify/curve_bank.hpp"

namespace slipwise {

/// What is taken of a car before it drives: straight curves.
struct CarPrior {
  double top_speed = 4.0;  ///< at full throttle [m/s]
  double curvature = 2.0;  ///< at full steering [1/m]
  /// What predictions take in place of the learned curves: a model as it is. Gates see the learned ones.
  std::optional<CarCurves> held = {};
};

/// How long what curves do not explain lasts: lags side by side, of which the one that predicts best counts.
class RestFilter {
 public:
  RestFilter();

  void start_run() { past_.clear(); }
  void learn(double t, double rest, double noise);
  double lag() const;
  /// What was left lately; 0 at first.
  double rest() const { return past_.empty() ? 0.0 : past_.back().second; }

  /// \throws std::invalid_argument where a loaded one is none that `made` could have become.
  void check_loaded(const RestFilter& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.score_, self.past_);
  }

 private:
  std::vector<double> score_;
  std::deque<std::pair<double, double>> past_;  ///< stamp [s] and rest, of the last twists
};

/// The factor that fits best so far.
struct ConstantGain {
  double products = 0.0, squares = 0.0;

  void learn(double input, double output) {
    products += input * output;
    squares += input * input;
  }
  double value() const { return products / squares; }
};

/// Follows one car through its runs.
class CarCurveFilter {
 public:
  CarCurveFilter() : CarCurveFilter(CarPrior{}) {}
  explicit CarCurveFilter(const CarPrior& prior);
  /// One that follows a car by known curves, and learns how it is set right alone.
  CarCurveFilter(const CarPrior& prior, const CarCurves& known);

  /// Another run begins: the car stands. What was learned stays, and competes with curves that begin again.
  void start_run(double t);
  /// Goes on to `until` [s] under the commands (v is the throttle, omega the steering), known from `reach()` before
  /// `until()` on. `twist` is the mean over this time as poses tell it; nullptr where they do not.
  void follow(const InputHistory& commands, double until, const BodyTwist* twist);

  static double reach();  ///< of the longest delay [s]
  double until() const { return until_; }
  const CarCurves& curves() const { return curves_; }
  /// Those that go on from all runs: curves that began again know little of throttles that they have not seen.
  const CarCurves& lasting() const { return lasting_; }
  /// A kinematic bicycle without lag, whose two constant gains are the best so far: what curves are held against.
  CarCurves straight() const;
  /// What it does now, followed by the curves and set right by what was measured.
  KnownMotion motion() const;
  /// The same at `t` [s] after that, under the commands. `twist` is the mean since then, which counts by `weight`, from
  /// 0 to 1: of a shorter time than those that are learned, it is less sure.
  KnownMotion motion(const InputHistory& commands, double t, const BodyTwist& twist, double weight) const;

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const CarCurveFilter& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.curves_, self.lasting_, self.speed_, self.turn_, self.ramps_, self.drags_, self.steering_, self.observers_,
      self.observer_score_);
    a(self.gain_, self.turn_gain_, self.until_, self.held_, self.learned_, self.turn_rest_, self.sideways_);
  }

 private:
  struct Means;
  /// Goes on under a held command that came with the delay of this place.
  void follow_candidates(std::size_t delay, const BodyTwist& command, double duration, Means& means);
  void follow_car(const BodyTwist& command, double duration, Means& means);
  void learn(const Means& means, const BodyTwist& twist);
  void set_curves();
  std::size_t best_observer() const;

  CarCurves curves_, lasting_;
  CurveCopies speed_, turn_;
  Eigen::MatrixXd ramps_;            ///< [ramps, lags of each delay] lagging ramps of the throttle
  Eigen::VectorXd drags_;            ///< [lags] lagging |omega V|
  Eigen::VectorXd steering_;         ///< [steering lags of each delay]
  std::vector<CarState> observers_;  ///< each set right by another part of what was measured
  std::vector<double> observer_score_;
  double until_ = 0.0;
  RestFilter turn_rest_, sideways_;
  ConstantGain gain_, turn_gain_;  ///< of the throttle [m/s], of throttle times steering [rad/s]
  BodyTwist held_{};               ///< the last measured twist
  std::size_t learned_ = 0;        ///< twists
  bool known_ = false;             ///< the curves; not saved, since what is saved learns
};

}  // namespace slipwise
