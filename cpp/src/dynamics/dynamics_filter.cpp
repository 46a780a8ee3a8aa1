// SPDX-License-Identifier: Apache-2.0
// Each measurement ends a window of the joint state; what the parameters do in it is found by integration.
#include "slipwise/dynamics/dynamics_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {
namespace {

constexpr double kPoseRows = 3.0;    // measurements in a segment, for which gate and Huber's bound are given
constexpr double kLongest = 3600.0;  // [s] between two measurements, and to a prediction
constexpr int kMostRejected = 5;     // in a row: then it is the state that is wrong

void need(bool fine, const char* fault) {
  if (!fine) {
    throw std::invalid_argument(fault);
  }
}

void check(const DynamicsSettings& settings, const Estimate& start) {
  const DynamicsNoise& noise = settings.noise;
  const Eigen::Index states = noise.psd.size();
  need(start.mean.size() >= states && start.covariance.rows() == start.mean.size() &&
           start.covariance.cols() == start.mean.size(),
       "the start must have the states and then the parameters, with a covariance of as many rows and columns");
  need(start.mean.allFinite() && start.covariance.allFinite(), "a number of the start is not finite");
  need(!noise.measured.empty() &&
           std::ranges::all_of(noise.measured, [&](Eigen::Index place) { return place >= 0 && place < states; }),
       "measurements must be places in the state, one at least");
  need(noise.angle.size() == noise.measured.size() &&
           noise.measurement_std.size() == static_cast<Eigen::Index>(noise.measured.size()),
       "each measured component needs a standard deviation, and whether it is an angle");
  need((noise.measurement_std.array() > 0.0).all() && noise.measurement_std.allFinite(),
       "standard deviations of measurements must be positive");
  need((noise.psd.array() >= 0.0).all() && noise.psd.allFinite(), "noise densities must not be negative");
  need(settings.longest_step > 0.0 && std::isfinite(settings.longest_step), "the longest step must be positive");
}

std::vector<std::vector<Eigen::Index>> each_alone(Eigen::Index size) {
  std::vector<std::vector<Eigen::Index>> groups;
  for (Eigen::Index i = 0; i < size; ++i) {
    groups.push_back({i});
  }
  return groups;
}

}  // namespace

DynamicsFilter::DynamicsFilter(std::shared_ptr<const DynamicsModel> model, const DynamicsSettings& settings, double t,
                               const Estimate& start)
    : model_(std::move(model)), settings_(settings), t_(t), states_(settings.noise.psd.size()), now_(start) {
  need(std::isfinite(t), "the stamp of the start is not finite");
  check(settings, start);
  const Eigen::Index parameters = start.mean.size() - states_;
  prior_ = start.covariance.bottomRightCorner(parameters, parameters);
  scores_ = ScoreCovariance(each_alone(parameters), parameters);
}

Estimate DynamicsFilter::state() const {
  return {now_.mean.head(states_), now_.covariance.topLeftCorner(states_, states_)};
}

Estimate DynamicsFilter::parameters() const {
  const Eigen::Index parameters = now_.mean.size() - states_;
  return {now_.mean.tail(parameters), now_.covariance.bottomRightCorner(parameters, parameters)};
}

Estimate DynamicsFilter::reported_parameters() const {
  Estimate known = parameters();
  const Eigen::VectorXd factors = scores_.std_factors(prior_, known.covariance);
  known.covariance = (factors.asDiagonal() * known.covariance * factors.asDiagonal()).eval();
  return known;
}

/// From (state, parameters) at the last measurement: the measurements at `end`, then both there.
WindowModel DynamicsFilter::window(const Eigen::VectorXd& start, double end) const {
  const Eigen::Index all = start.size();
  const Eigen::Index parameters = all - states_;
  const DynamicsNoise& noise = settings_.noise;
  const auto rows = static_cast<Eigen::Index>(noise.measured.size());
  const DynamicsEnd moved = integrate_dynamics(
      *model_, inputs_, {.start = t_, .end = end, .longest_step = settings_.longest_step, .psd = noise.psd},
      start.head(states_), start.tail(parameters));
  WindowModel at{.measured = rows,
                 .value = Eigen::VectorXd(rows + all),
                 .derivative = Eigen::MatrixXd::Zero(rows + all, all),
                 .noise = Eigen::MatrixXd::Zero(rows + all, rows + all)};
  at.value << moved.state(noise.measured), moved.state, start.tail(parameters);
  at.derivative.topRows(rows) = moved.by_start(noise.measured, Eigen::all);
  at.derivative.middleRows(rows, states_) = moved.by_start;
  at.derivative.bottomRightCorner(parameters, parameters).setIdentity();
  const Eigen::MatrixXd measured_noise = moved.noise(noise.measured, Eigen::all);
  at.noise.topLeftCorner(rows, rows) = measured_noise(Eigen::all, noise.measured);
  at.noise.topLeftCorner(rows, rows).diagonal() += noise.measurement_std.cwiseAbs2();
  at.noise.block(0, rows, rows, states_) = measured_noise;
  at.noise.block(rows, 0, states_, rows) = measured_noise.transpose();
  at.noise.block(rows, rows, states_, states_) = moved.noise;
  return at;
}

DynamicsUpdate DynamicsFilter::push_measurement(double t, const Eigen::VectorXd& measured) {
  need(std::isfinite(t) && measured.allFinite(), "a measurement or its stamp is not finite");
  need(t > t_, "measurements must be in the order of their stamps, each later than the last");
  need(t - t_ <= kLongest, "a measurement comes more than an hour after the last; begin with another filter");
  need(measured.size() == static_cast<Eigen::Index>(settings_.noise.measured.size()),
       "a measurement has another size than the measured places");
  need(!inputs_.empty(), "there is no input yet; push one that begins no later than the first measurement");
  const DynamicsUpdate update = learned(t, measured);
  inputs_.forget_before(t);
  t_ = t;
  return update;
}

DynamicsUpdate DynamicsFilter::learned(double t, const Eigen::VectorXd& measured) {
  WindowModel expected = window(now_.mean, t);
  const Eigen::Index rows = expected.measured;
  Eigen::VectorXd innovation = measured - expected.observed();
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (settings_.noise.angle[static_cast<std::size_t>(i)]) {
      innovation[i] = wrap_angle(innovation[i]);
    }
  }
  const Eigen::VectorXd seen = expected.observed() + innovation;  // angles without whole turns
  const Eigen::MatrixXd s = innovation_covariance(now_, expected);
  DynamicsUpdate update{
      .innovation = innovation, .nis = normalised_square(innovation, s), .weight = 1.0, .status = Status::Converged};
  const double squared = update.nis * kPoseRows / static_cast<double>(rows);  // as if of three measurements
  const bool beyond = !(squared <= settings_.iekf.gate);
  if (beyond && rejected_in_a_row_ < kMostRejected) {
    ++rejected_in_a_row_;
    const Eigen::MatrixXd by = expected.derivative.bottomRows(now_.mean.size());
    const Eigen::MatrixXd moved =
        by * now_.covariance * by.transpose() + expected.noise.bottomRightCorner(by.rows(), by.rows());
    now_ = {expected.value.tail(by.rows()), (moved + moved.transpose()) / 2.0};
    update.weight = 0.0;
    update.status = Status::Rejected;
    return update;
  }
  rejected_in_a_row_ = 0;
  Eigen::MatrixXd more = Eigen::MatrixXd::Zero(rows, rows);  // noise of a measurement that counts for less
  if (const double sigmas = std::sqrt(squared); sigmas > settings_.iekf.huber) {
    update.weight = settings_.iekf.huber / sigmas;
    update.status = Status::Downweighted;
    more = (1.0 / update.weight - 1.0) * s;
  }
  const MeasurementFunction predict = [&](const Eigen::VectorXd& start) {
    WindowModel at = window(start, t);
    at.noise.topLeftCorner(rows, rows) += more;
    return at;
  };
  expected.noise.topLeftCorner(rows, rows) += more;
  const WindowPoint point = most_probable_start(now_, expected, predict, seen, settings_.iekf);
  add_score(expected, innovation, expected.noise.topLeftCorner(rows, rows), t);
  now_ = end_estimate(now_, point, seen);
  return update;
}

/// Given the parameters, the state is known about a line: what a measurement says of the parameters is its derivative
/// along that line, and the open part of the state is noise to it.
void DynamicsFilter::add_score(const WindowModel& at, const Eigen::VectorXd& innovation, const Eigen::MatrixXd& noise,
                               double t) {
  const Eigen::Index parameters = now_.mean.size() - states_;
  if (parameters == 0) {
    return;
  }
  const Eigen::MatrixXd& p = now_.covariance;
  const Eigen::MatrixXd of_parameters = p.bottomRightCorner(parameters, parameters);
  const Eigen::MatrixXd cross = p.topRightCorner(states_, parameters);
  const Cholesky known(of_parameters);
  if (!known.positive_definite()) {
    return;  // of parameters that are taken as they are
  }
  const Eigen::MatrixXd line = known.solve(Eigen::MatrixXd(cross.transpose())).transpose();  // [states, parameters]
  const Eigen::MatrixXd by_state = at.observed_jacobian().leftCols(states_);
  const Eigen::MatrixXd jacobian = at.observed_jacobian().rightCols(parameters) + by_state * line;
  const Eigen::MatrixXd left = p.topLeftCorner(states_, states_) - line * cross.transpose();
  scores_.add({.jacobian = jacobian,
               .residual = innovation,
               .covariance = of_parameters,
               .noise = noise + by_state * left * by_state.transpose(),
               .t = t});
}

std::vector<DynamicsPrediction> DynamicsFilter::predict(const std::vector<double>& times,
                                                        const HeldInputs& future) const {
  const HeldInputs& inputs = future.empty() ? inputs_ : future;
  const Eigen::Index parameters = now_.mean.size() - states_;
  Estimate known = now_;
  known.covariance.bottomRightCorner(parameters, parameters) = reported_parameters().covariance;
  std::vector<DynamicsPrediction> found;
  double t = t_;
  DynamicsEnd now = nothing_passed(known.mean.head(states_), parameters);
  for (const double end : times) {
    need(std::isfinite(end) && end >= t, "times to predict must be in order, and not before the last measurement");
    need(end - t_ <= kLongest, "a prediction reaches an hour at most");
    now = integrate_dynamics(
        *model_, inputs, {.start = t, .end = end, .longest_step = settings_.longest_step, .psd = settings_.noise.psd},
        std::move(now), known.mean.tail(parameters));
    t = end;
    const Eigen::MatrixXd spread = now.by_start * known.covariance * now.by_start.transpose() + now.noise;
    found.push_back({.t = end, .state = now.state, .covariance = (spread + spread.transpose()) / 2.0});
  }
  return found;
}

}  // namespace slipwise
