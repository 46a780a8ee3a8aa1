// SPDX-License-Identifier: Apache-2.0
// Gauss-Newton on the way over a stretch, and what of it the means of neighbouring positions tell
// (derivations/sensors.md).
#include "slipwise/online/position_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "slipwise/lie/se2.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kFactor, 1.0);       // standard deviation of factors of the way and of the turn
SLIPWISE_TUNING(kTurned, 0.3);       // [rad/m] of what it turns per way
SLIPWISE_TUNING(kUsual, 0.01);       // [m] noise of positions before residuals show it
SLIPWISE_TUNING(kSpread, 0.07);      // [m] a way that spreads less has no course to speak of,
constexpr double kOfNoise = 2.0;     // and no more has one that spreads by less than so many stated standard deviations
constexpr double kUsualCount = 4.0;  // residuals that this is worth
constexpr double kWaysDiffer = 3.0;  // a way and that by the inputs may differ by this factor
constexpr std::size_t kFewest = 3;   // positions
constexpr int kIterations = 10;
constexpr int kHalvings = 5;
constexpr double kConverged = 1e-4;  // of the standard deviations above

using Deviations = Eigen::Vector3d;  // factors: of the way less 1, of the turn less 1; and turn per way [rad/m]
using ManyPositions = Eigen::Matrix<double, 2, Eigen::Dynamic>;
using ByDeviations = Eigen::Matrix<double, 2, 3>;

Eigen::Vector2d left_of(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

/// Where the robot is, and how that follows from the deviations.
struct Reached {
  Pose2 pose = {};
  Eigen::Matrix3d by = Eigen::Matrix3d::Zero();

  void drive(const BodyTwist& twist, double seconds, const Deviations& off) {
    const double way = 1.0 + off[0];
    const Eigen::Vector3d tangent(twist.v * way, twist.vy * way, twist.omega * (1.0 + off[1]) + twist.v * off[2]);
    Eigen::Matrix3d tangent_by = Eigen::Matrix3d::Zero();
    tangent_by.col(0) << twist.v, twist.vy, 0.0;
    tangent_by(2, 1) = twist.omega;
    tangent_by(2, 2) = twist.v;
    const Eigen::Vector3d moved = tangent * seconds;
    const Pose2 next = compose(pose, exp(moved));
    Eigen::Matrix3d added = chart_jacobian(moved) * tangent_by * seconds;
    added.topRows<2>() = (rotation(pose.theta) * added.topRows<2>()).eval();
    by = transition(pose, next) * by + added;
    pose = next;
  }
};

/// What is compared with positions: the way of the inputs, at some stamps in order.
class Way {
 public:
  Way(const InputBuffer& inputs, std::vector<double> stamps, const Pose2& place)
      : held_(inputs.held(stamps.front(), stamps.back())), stamps_(std::move(stamps)), place_(place) {}

  std::vector<Reached> driven(const Deviations& off) const {
    std::vector<Reached> found;
    found.reserve(stamps_.size());
    Reached now;
    double t = stamps_.front();
    auto piece = held_.begin();
    for (const double stamp : stamps_) {
      while (t < stamp) {
        const double until = std::next(piece) == held_.end() ? stamp : std::min(stamp, std::next(piece)->t);
        now.drive(piece->twist, std::max(until - t, 0.0), off);
        t = until;
        piece += std::next(piece) != held_.end() && !(t < std::next(piece)->t) ? 1 : 0;
      }
      found.push_back(now);
    }
    return found;
  }
  Eigen::Vector2d position(const Reached& at) const { return sensor_motion(at.pose, place_).vector().head<2>(); }
  ByDeviations by_deviations(const Reached& at) const { return sensor_by_robot(at.pose, place_).topRows<2>() * at.by; }
  Eigen::Vector3d motion(const Reached& end) const { return sensor_motion(end.pose, place_).vector(); }
  Eigen::Matrix3d motion_by(const Reached& end) const { return sensor_by_robot(end.pose, place_) * end.by; }

 private:
  std::vector<InputSample> held_;
  std::vector<double> stamps_;
  Pose2 place_;
};

/// Positions of a way, their weighted mean being zero, and how they follow from the deviations apart from where the way
/// lies.
struct Shape {
  ManyPositions at;
  std::vector<ByDeviations> by;

  Shape(const Way& way, const std::vector<Reached>& reached, const Eigen::VectorXd& weights)
      : at(2, std::ssize(reached)) {
    for (const Reached& each : reached) {
      at.col(std::ssize(by)) = way.position(each);
      by.push_back(way.by_deviations(each));
    }
    at.colwise() -= (at * weights / weights.sum()).eval();
    ByDeviations moved = ByDeviations::Zero();
    Eigen::RowVector3d turned = Eigen::RowVector3d::Zero();
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
      const ByDeviations& each = by[static_cast<std::size_t>(i)];
      moved += weights[i] * each;
      turned += weights[i] * left_of(at.col(i)).transpose() * each;
    }
    moved /= weights.sum();
    turned /= std::max(weighted_square(weights), kSpread * kSpread * kFewest);
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
      by[static_cast<std::size_t>(i)] -= moved + left_of(at.col(i)) * turned;
    }
  }
  double weighted_square(const Eigen::VectorXd& weights) const { return at.colwise().squaredNorm() * weights; }
};

Eigen::Matrix3d prior_information() {
  return Eigen::Vector3d(kFactor, kFactor, kTurned).cwiseAbs2().cwiseInverse().asDiagonal();
}

/// The sum of weighted squares that deviations are fitted by, with all that a step of Gauss-Newton needs.
struct Problem {
  Shape shape;
  ManyPositions laid;  ///< the measured positions as they lie best on the shape
  double angle;        ///< by which they are turned for that [rad]
  double squares;

  Problem(const Way& way, const Deviations& off, const ManyPositions& measured, const Eigen::VectorXd& weights)
      : shape(way, way.driven(off), weights) {
    double along = 0.0;
    double across = 0.0;
    for (Eigen::Index i = 0; i < measured.cols(); ++i) {
      along += weights[i] * measured.col(i).dot(shape.at.col(i));
      across += weights[i] * left_of(measured.col(i)).dot(shape.at.col(i));
    }
    angle = std::atan2(across, along);
    laid = rotation(angle) * measured;
    squares = (laid - shape.at).colwise().squaredNorm() * weights;
  }

  Deviations step(const Eigen::VectorXd& weights, const Deviations& off, double variance) const {
    Eigen::Matrix3d information = variance * prior_information();
    Eigen::Vector3d gradient = -information * off;
    for (Eigen::Index i = 0; i < laid.cols(); ++i) {
      const ByDeviations& by = shape.by[static_cast<std::size_t>(i)];
      information += weights[i] * by.transpose() * by;
      gradient += weights[i] * by.transpose() * (laid.col(i) - shape.at.col(i));
    }
    return information.ldlt().solve(gradient);
  }
};

/// Of one position of usual noise, as the residuals show it.
double variance_of(const Problem& problem) {
  const auto numbers = static_cast<double>(2 * problem.laid.cols() - 6);
  return (problem.squares + kUsualCount * kUsual * kUsual) / (numbers + kUsualCount);
}

struct Fit {
  Deviations off = Deviations::Zero();
  double variance = 0.0;
};

Fit fitted(const Way& way, const ManyPositions& measured, const Eigen::VectorXd& weights) {
  Fit fit;
  Problem now(way, fit.off, measured, weights);
  const Eigen::Matrix3d prior = prior_information();
  for (int i = 0; i < kIterations; ++i) {
    fit.variance = variance_of(now);
    Deviations step = now.step(weights, fit.off, fit.variance);
    const double before = now.squares + fit.variance * fit.off.dot(prior * fit.off);
    bool better = false;
    for (int k = 0; k < kHalvings && !better; ++k) {
      const Deviations next = fit.off + step;
      Problem there(way, next, measured, weights);
      better = there.squares + fit.variance * next.dot(prior * next) < before;
      if (better) {
        now = std::move(there);
        fit.off = next;
      } else {
        step *= 0.5;
      }
    }
    if (!better || step.dot(prior * step) < kConverged * kConverged) {
      break;
    }
  }
  fit.variance = variance_of(now);
  return fit;
}

ManyPositions centred(const std::vector<MeasuredPose>& positions, const Eigen::VectorXd& weights) {
  ManyPositions found(2, std::ssize(positions));
  for (Eigen::Index i = 0; i < found.cols(); ++i) {
    const MeasuredPose& each = positions[static_cast<std::size_t>(i)];
    found.col(i) << each.x - positions.front().x, each.y - positions.front().y;
  }
  found.colwise() -= (found * weights / weights.sum()).eval();
  return found;
}

Eigen::VectorXd weights_of(const std::vector<MeasuredPose>& positions) {
  Eigen::VectorXd weights(std::ssize(positions));
  std::ranges::transform(positions, weights.begin(),
                         [](const MeasuredPose& each) { return 1.0 / (each.std_ratio.xy * each.std_ratio.xy); });
  return weights;
}

std::vector<double> stamps_of(const std::vector<MeasuredPose>& positions) {
  std::vector<double> stamps;
  std::ranges::transform(positions, std::back_inserter(stamps), &MeasuredPose::t);
  return stamps;
}

/// Whether the way tells a course, and is about that of the inputs.
bool moves(const std::vector<MeasuredPose>& positions, const ManyPositions& measured, const Shape& reckoned,
           const Eigen::VectorXd& weights) {
  double stated = 0.0;
  for (const MeasuredPose& each : positions) {
    stated = std::max(stated, each.std.xy);
  }
  const double is = std::sqrt(measured.colwise().squaredNorm().dot(weights) / weights.sum());
  const double expected = std::sqrt(reckoned.weighted_square(weights) / weights.sum());
  const bool same = is <= kWaysDiffer * expected && expected <= kWaysDiffer * is;
  return same && std::min(is, expected) >= std::max(double{kSpread}, kOfNoise * stated);
}

/// Means of neighbours, as many as a sensor looks at.
struct Means {
  std::vector<double> stamps;
  OfPositions weights;
  Positions apart;  ///< from the fitted way
};

Means means_of(const std::vector<double>& stamps, const Eigen::VectorXd& weights, const ManyPositions& apart) {
  const auto all = static_cast<Eigen::Index>(stamps.size());
  const Eigen::Index count = std::min(all, static_cast<Eigen::Index>(kMostMoments));
  Means means{.stamps = {}, .weights = OfPositions::Zero(count), .apart = Positions::Zero(2, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    double t = 0.0;
    for (Eigen::Index i = k * all / count; i < (k + 1) * all / count; ++i) {
      means.weights[k] += weights[i];
      means.apart.col(k) += weights[i] * apart.col(i);
      t += weights[i] * (stamps[static_cast<std::size_t>(i)] - stamps.front());
    }
    means.apart.col(k) /= means.weights[k];
    means.stamps.push_back(stamps.front() + t / means.weights[k]);
  }
  return means;
}

/// How the motion changes with differences of the means: by what the deviations become with them.
PositionSensor sensor_of(const Way& way, const std::vector<Reached>& reached, const Means& means, double variance) {
  const std::vector<Reached> seen(reached.begin() + 1, reached.end() - 1);
  const Shape shape(way, seen, means.weights);
  Eigen::Matrix3d information = variance * prior_information();
  for (std::size_t k = 0; k < shape.by.size(); ++k) {
    information += means.weights[static_cast<Eigen::Index>(k)] * shape.by[k].transpose() * shape.by[k];
  }
  const Eigen::Matrix3d motion_by = way.motion_by(reached.back()) * information.inverse();
  PositionSensor sensor{.at = Eigen::Map<const Eigen::VectorXd>(means.stamps.data(), std::ssize(means.stamps)),
                        .weights = means.weights / variance,
                        .fitted = shape.at,
                        .motion = way.motion(reached.back())};
  sensor.gain.resize(3, 2 * std::ssize(means.stamps));
  for (std::size_t k = 0; k < shape.by.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    sensor.gain.middleCols<2>(2 * i) = means.weights[i] * motion_by * shape.by[k].transpose();
  }
  return sensor;
}

}  // namespace

std::optional<FittedPositions> fit_positions(const std::vector<MeasuredPose>& positions, double end,
                                             const InputBuffer& inputs, const Pose2& place) {
  if (positions.size() < kFewest || inputs.empty() || inputs.unknown_since(positions.front().t, end)) {
    return std::nullopt;
  }
  const Eigen::VectorXd weights = weights_of(positions);
  const std::vector<double> stamps = stamps_of(positions);
  const ManyPositions measured = centred(positions, weights);
  const Way way(inputs, stamps, place);
  if (!moves(positions, measured, Shape(way, way.driven(Deviations::Zero()), weights), weights)) {
    return std::nullopt;
  }
  const Fit fit = fitted(way, measured, weights);
  const Problem best(way, fit.off, measured, weights);
  const Means means = means_of(stamps, weights, best.laid - best.shape.at);
  std::vector<double> looked = {positions.front().t};
  looked.insert(looked.end(), means.stamps.begin(), means.stamps.end());
  looked.push_back(end);
  const Way whole(inputs, looked, place);
  PositionSensor sensor = sensor_of(whole, whole.driven(fit.off), means, fit.variance);
  const Eigen::Vector3d z = sensor.motion_by(sensor.fitted + means.apart);
  return z.allFinite() ? std::optional(FittedPositions{.sensor = std::move(sensor),
                                                       .z = z,
                                                       .heading = -best.angle - place.theta,
                                                       .std = std::sqrt(fit.variance)})
                       : std::nullopt;
}

}  // namespace slipwise
