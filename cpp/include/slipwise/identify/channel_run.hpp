// SPDX-License-Identifier: Apache-2.0
// All windows of one channel learned about one point of its actuator parameters, and how probable that point is.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "slipwise/filter/iekf.hpp"
#include "slipwise/identify/axis_window.hpp"
#include "slipwise/linear/gauss_newton.hpp"

namespace slipwise {

/// Where these are among (v, vy, omega).
std::vector<std::size_t> places_in_twist(const std::vector<double BodyTwist::*>& parts);
/// The reverse. \throws std::invalid_argument where there is no such place.
std::vector<double BodyTwist::*> parts_of_twist(const std::vector<std::size_t>& places);

/// Axes that share their parameters, their prior, and what else moves the wheels.
struct ChannelModel {
  std::vector<double BodyTwist::*> parts;
  Estimate prior;
  ActuatorNoise noise;  ///< a shape, whose size is learned
  IekfSettings iekf;    ///< gate and Huber's bound

  /// Names what is saved: of the parts, their places in a twist.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    auto places = places_in_twist(self.parts);  // NOLINT(misc-const-correctness): a reader changes them
    a(places, self.prior, self.noise, self.iekf);
    if constexpr (!std::is_const_v<Self>) {
      self.parts = parts_of_twist(places);
    }
  }
};

/// -2 log density under a Student t of `count` values, without constants.
double student_cost(double nis, double log_determinant, Eigen::Index count);

/// By how much the noise of a window is larger than nominal, by the rule of the IEKF; none where it is rejected.
double noise_inflation(double nis, Eigen::Index count, const IekfSettings& settings);

struct ChannelRun {
  double cost;                    ///< -2 log posterior of the point, exact but for weights of outliers
  Estimate joint;                 ///< [parameters; per axis that is followed at the end: its state]
  std::vector<std::size_t> live;  ///< these axes, by their places among the parts
  double until = -std::numeric_limits<double>::infinity();  ///< [s] the end
};

/// An axis's state for given parameters, and how it moves with them.
struct FollowedAxis {
  std::size_t place;  ///< among the parts
  AxisVector mean;
  Eigen::Matrix<double, kAxisStates, kAxisStates> covariance;
  Eigen::Matrix<double, kAxisStates, kChannelParameters> by_actuator;
};

/// For given parameters the actuator is linear in its state, and the axes are independent: small filters follow them
/// exactly, and their likelihood is that of the parameters. How their innovations move with the parameters tells these
/// (Friedland 1969): the joint filter, linearised along the way. `size` is that of the noise.
class ChannelFilter {
 public:
  ChannelFilter() = default;
  ChannelFilter(std::shared_ptr<const ChannelModel> model, double size, const ChannelParameters& point);
  /// Learns a window that follows all before it.
  void learn(const ChannelWindow& window);
  ChannelRun result() const;
  /// Of the parameters, at the point.
  NormalEquations equations() const;
  double cost() const { return cost_; }  ///< -2 log posterior of the point

  /// \throws std::invalid_argument where a loaded one does not fit the model.
  void check_loaded(const ChannelModel& model) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.size_, self.point_, self.cost_, self.information_, self.gradient_, self.axes_, self.until_);
  }

 private:
  struct Learned;
  void begin(const ChannelWindow& window);
  Learned filter(const FollowedAxis& axis, const AxisMotion& motion, const WheelMeans& observed, double size) const;

  std::shared_ptr<const ChannelModel> model_;
  double size_ = 0.0;
  ChannelParameters point_;
  double cost_ = 0.0;
  Eigen::Matrix<double, kChannelParameters, kChannelParameters> information_;  ///< of the parameters
  ChannelParameters gradient_;                                                 ///< of half the cost by them, downhill
  std::vector<FollowedAxis> axes_;
  double until_ = -std::numeric_limits<double>::infinity();
};

}  // namespace slipwise
