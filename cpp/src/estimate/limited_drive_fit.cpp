// SPDX-License-Identifier: Apache-2.0
// A Student t likelihood of wheel speeds over the parameters of a limited drive, on a logarithmic scale where positive.
#include "slipwise/estimate/limited_drive_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "slipwise/actuator/chain_output.hpp"

namespace slipwise {
namespace {

constexpr double kDof = 4.0;          // of the residuals
constexpr double kLeastScale = 1e-3;  // [m/s, rad/s]; encoders are no finer
constexpr int kScaleSteps = 6;        // of finding the likeliest scale
constexpr double kTrackLogStd = 0.5;  // of the track between the sides about the one given
constexpr double kDifference = 1e-2;  // of parameters, for derivatives; the pieces of ramps make smaller ones rough
constexpr double kMostInflation = 100.0;
constexpr double kSecondsAlike = 1.0;  // residuals further apart are taken as independent
constexpr int kOutputs = 2;
constexpr double kLeastGain = 0.05;  // a drive does not turn its commands round

// Parameters in a row: gain, log lag and log delay per channel, log track, and per lane log top, acceleration, braking.
constexpr int kChain = 6;
constexpr int kTrack = 6;
constexpr int kFirstLimit = 7;
constexpr int kPerLane = 3;
using Parameters = Eigen::Matrix<double, kFirstLimit + 3 * kPerLane, 1>;

/// Where a lane's limit of a kind stands; dead-bands are no smooth parameters.
int place_of(std::size_t lane, std::size_t kind) {
  return kFirstLimit + static_cast<int>(lane) * kPerLane + static_cast<int>(kind) - 1;
}

Parameters parameters_of(const LimitedDrive& drive) {
  const CommandChain& chain = drive.chain;
  const CommandLimits& limits = drive.limits;
  Parameters p;
  p.head<kFirstLimit>() << limits.gain_v, limits.gain_omega, std::log(chain.lag_v), std::log(chain.lag_omega),
      std::log(chain.delay_v), std::log(chain.delay_omega), std::log(limits.track);
  for (std::size_t lane = 0; lane < kLanes.size(); ++lane) {
    for (std::size_t kind = 1; kind < kLimitKinds.size(); ++kind) {
      p[place_of(lane, kind)] = std::log(limit_of(lane_of(limits, kLanes.at(lane)), kLimitKinds.at(kind)));
    }
  }
  return p;
}

LimitedDrive with_parameters(LimitedDrive drive, const Parameters& p) {
  CommandChain& chain = drive.chain;
  drive.limits.gain_v = std::max(p[0], kLeastGain);
  drive.limits.gain_omega = std::max(p[1], kLeastGain);
  chain.lag_v = std::exp(p[2]);
  chain.lag_omega = std::exp(p[3]);
  chain.delay_v = std::exp(p[4]);
  chain.delay_omega = std::exp(p[5]);
  drive.limits.track = std::exp(p[kTrack]);
  for (std::size_t lane = 0; lane < kLanes.size(); ++lane) {
    for (std::size_t kind = 1; kind < kLimitKinds.size(); ++kind) {
      limit_of(lane_of(drive.limits, kLanes.at(lane)), kLimitKinds.at(kind)) = std::exp(p[place_of(lane, kind)]);
    }
  }
  if (drive.edge && drive.limits.side.dead_band > 0.0) {
    const auto& [blocked, passed] = *drive.edge;
    drive.limits.side.dead_band = 0.5 * (speed_of_side(drive.limits, blocked) + speed_of_side(drive.limits, passed));
  }
  return drive;
}

/// The parameters that do anything.
std::vector<int> free_parameters(const LimitedDrive& drive) {
  std::vector<int> free(kChain);
  std::iota(free.begin(), free.end(), 0);
  if (limits_sides(drive.limits)) {
    free.push_back(kTrack);
  }
  for (std::size_t lane = 0; lane < kLanes.size(); ++lane) {
    for (std::size_t kind = 1; kind < kLimitKinds.size(); ++kind) {
      if (limits_anything(lane_of(drive.limits, kLanes.at(lane)), kLimitKinds.at(kind))) {
        free.push_back(place_of(lane, kind));
      }
    }
  }
  return free;
}

/// The likeliest scale of Student t residuals.
double likeliest_scale(const Eigen::Ref<const Eigen::VectorXd>& residual) {
  double squared = std::max(residual.squaredNorm() / static_cast<double>(residual.size()), kLeastScale * kLeastScale);
  for (int i = 0; i < kScaleSteps; ++i) {
    const auto r2 = residual.array().square();
    squared = std::max(((kDof + 1.0) * r2 / (kDof + r2 / squared)).mean(), kLeastScale * kLeastScale);
  }
  return std::sqrt(squared);
}

double chi(double value, double std) { return (value / std) * (value / std); }

double LaneLimits::* member_of(LimitKind kind) {
  switch (kind) {
    case LimitKind::DeadBand:
      return &LaneLimits::dead_band;
    case LimitKind::Top:
      return &LaneLimits::top;
    case LimitKind::Acceleration:
      return &LaneLimits::acceleration;
    default:
      return &LaneLimits::braking;
  }
}

LaneLimits CommandLimits::* member_of(Lane lane) {
  switch (lane) {
    case Lane::Speed:
      return &CommandLimits::speed;
    case Lane::YawRate:
      return &CommandLimits::yaw_rate;
    default:
      return &CommandLimits::side;
  }
}

}  // namespace

double& limit_of(LaneLimits& limits, LimitKind kind) { return limits.*member_of(kind); }

double limit_of(const LaneLimits& limits, LimitKind kind) { return limits.*member_of(kind); }

bool limits_anything(const LaneLimits& limits, LimitKind kind) {
  return limit_of(limits, kind) != limit_of(LaneLimits{}, kind);
}

LaneLimits& lane_of(CommandLimits& limits, Lane lane) { return limits.*member_of(lane); }

const LaneLimits& lane_of(const CommandLimits& limits, Lane lane) { return limits.*member_of(lane); }

double speed_of_side(const CommandLimits& limits, const SideCommand& command) {
  return std::abs(limits.gain_v * command.v + 0.5 * limits.gain_omega * command.omega * limits.track);
}

/// Measured less explained, one column per channel, with the scale and the t weights of each.
struct LimitedDriveFit::Residuals {
  Eigen::MatrixXd value;  // [samples, channels]
  Eigen::Vector2d scale;
  Eigen::MatrixXd weight;  // [samples, channels]
};

LimitedDriveFit::LimitedDriveFit(std::span<const DriveRecord> records, const PriorSettings& prior, double track)
    : records_(records), prior_(prior), track_(track) {
  for (const DriveRecord& record : records) {
    samples_ += record.t.empty() ? 0 : record.t.size() - 1;
  }
}

LimitedDrive LimitedDriveFit::start() const {
  LimitedDrive drive;
  drive.limits.track = track_;
  drive.chain.lag_v = drive.chain.lag_omega = prior_.lag;
  drive.chain.delay_v = drive.chain.delay_omega = prior_.delay;
  return drive;
}

std::vector<InputTrack> LimitedDriveFit::limited(const CommandLimits& limits) const {
  std::vector<InputTrack> tracks;
  tracks.reserve(records_.size());
  for (const DriveRecord& record : records_) {
    tracks.push_back(limited_track(record.commands, limits));
  }
  return tracks;
}

Eigen::MatrixXd LimitedDriveFit::errors(const LimitedDrive& drive, std::span<const InputTrack> limited) const {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(samples_), kOutputs);
  CommandChain chain = drive.chain;
  if (!limits_sides(drive.limits)) {
    chain.gain_v = drive.limits.gain_v;
    chain.gain_omega = drive.limits.gain_omega;
  }
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const DriveRecord& record = records_[k];
    const ChainOutput output = chain_output(limited[k], chain, record.t, record.wheels.front());
    for (std::size_t i = 1; i < record.t.size(); ++i, ++row) {
      result(row, 0) = record.wheels[i].v - output.v[i];
      result(row, 1) = record.wheels[i].omega - output.omega[i];
    }
  }
  return result;
}

LimitedDriveFit::Residuals LimitedDriveFit::residuals(const LimitedDrive& drive) const {
  Residuals result{.value = errors(drive, limited(drive.limits)), .scale = {}, .weight = {}};
  result.weight.resize(result.value.rows(), kOutputs);
  for (int c = 0; c < kOutputs; ++c) {
    result.scale[c] = likeliest_scale(result.value.col(c));
    result.weight.col(c) = (kDof + 1.0) / (kDof + (result.value.col(c).array() / result.scale[c]).square());
  }
  return result;
}

double LimitedDriveFit::prior_loss(const LimitedDrive& drive) const {
  const CommandChain& chain = drive.chain;
  return chi(drive.limits.gain_v - 1.0, prior_.gain_std) + chi(drive.limits.gain_omega - 1.0, prior_.gain_std) +
         chi(std::log(chain.lag_v / prior_.lag), prior_.log_std) +
         chi(std::log(chain.lag_omega / prior_.lag), prior_.log_std) +
         chi(std::log(chain.delay_v / prior_.delay), prior_.log_std) +
         chi(std::log(chain.delay_omega / prior_.delay), prior_.log_std) +
         chi(std::log(drive.limits.track / track_), kTrackLogStd);
}

DriveLoss LimitedDriveFit::loss(const LimitedDrive& drive) const {
  const Residuals r = residuals(drive);
  const auto count = static_cast<double>(r.value.rows());
  DriveLoss loss{.total = prior_loss(drive), .inflation = 1.0};
  for (int c = 0; c < kOutputs; ++c) {
    const Eigen::ArrayXd scaled = r.value.col(c).array() / r.scale[c];
    loss.total += 2.0 * count * std::log(r.scale[c]) + (kDof + 1.0) * (1.0 + scaled.square() / kDof).log().sum();
    const Eigen::ArrayXd score = r.weight.col(c).array() * scaled;
    const double alike = (score.tail(score.size() - 1) * score.head(score.size() - 1)).sum() / score.square().sum();
    const double one = std::clamp((1.0 + alike) / (1.0 - alike), 1.0, kMostInflation);
    loss.inflation = std::max(loss.inflation, one);
  }
  return loss;
}

Eigen::MatrixXd LimitedDriveFit::jacobian(const LimitedDrive& drive, const std::vector<int>& free,
                                          const Residuals& at) const {
  const Parameters p = parameters_of(drive);
  const std::vector<InputTrack> tracks = limited(drive.limits);  // the same for all that stands behind the limits
  Eigen::MatrixXd result(at.value.size(), free.size());
  for (std::size_t k = 0; k < free.size(); ++k) {
    Parameters moved = p;
    moved[free[k]] += kDifference;
    const LimitedDrive other = with_parameters(drive, moved);
    const bool behind = free[k] < kChain && (free[k] >= 2 || !limits_sides(drive.limits));
    const Eigen::MatrixXd change = errors(other, behind ? tracks : limited(other.limits)) - at.value;
    result.col(static_cast<Eigen::Index>(k)) = change.reshaped() * (-1.0 / kDifference);
  }
  return result;
}

namespace {

/// Prior precision of a parameter, and how far it lies from its prior mean.
struct PriorPull {
  double precision, gap;
};

PriorPull prior_pull(int parameter, const Parameters& p, const PriorSettings& prior, double track) {
  const auto pull = [](double std, double gap) { return PriorPull{1.0 / (std * std), gap}; };
  if (parameter < 2) {
    return pull(prior.gain_std, p[parameter] - 1.0);
  }
  if (parameter < 4) {
    return pull(prior.log_std, p[parameter] - std::log(prior.lag));
  }
  if (parameter < kChain) {
    return pull(prior.log_std, p[parameter] - std::log(prior.delay));
  }
  return parameter == kTrack ? pull(kTrackLogStd, p[kTrack] - std::log(track)) : PriorPull{0.0, 0.0};
}

}  // namespace

LimitedDrive LimitedDriveFit::refine(const LimitedDrive& drive, int iterations) const {
  const std::vector<int> free = free_parameters(drive);
  const auto size = static_cast<Eigen::Index>(free.size());
  LimitedDrive best = drive;
  double least = loss(best).total;
  double damping = 1e-3;
  for (int i = 0; i < iterations; ++i) {
    const Residuals r = residuals(best);
    const Eigen::MatrixXd slope = jacobian(best, free, r);
    Eigen::MatrixXd weighted = r.weight;
    weighted.array().rowwise() /= r.scale.array().square().transpose();
    const Eigen::VectorXd weight = weighted.reshaped();
    Eigen::MatrixXd information = slope.transpose() * weight.asDiagonal() * slope;
    Eigen::VectorXd pull = slope.transpose() * (weight.array() * r.value.reshaped().array()).matrix();
    const Parameters p = parameters_of(best);
    for (Eigen::Index k = 0; k < size; ++k) {
      const PriorPull prior = prior_pull(free[static_cast<std::size_t>(k)], p, prior_, track_);
      information(k, k) += prior.precision;
      pull[k] -= prior.precision * prior.gap;
    }
    const double before = least;
    for (int attempt = 0; attempt < 6; ++attempt) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() += damping * information.diagonal() + Eigen::VectorXd::Constant(size, 1e-9);
      const Eigen::VectorXd step = damped.ldlt().solve(pull).cwiseMax(-0.7).cwiseMin(0.7);
      Parameters moved = p;
      for (Eigen::Index k = 0; k < size; ++k) {
        moved[free[static_cast<std::size_t>(k)]] += step[k];
      }
      const LimitedDrive trial = with_parameters(best, moved);
      const double total = loss(trial).total;
      if (total < least) {
        best = trial;
        least = total;
        damping = std::max(damping * 0.2, 1e-6);
        break;
      }
      damping *= 8.0;
    }
    if (before - least < 0.02) {
      break;
    }
  }
  return best;
}

namespace {

/// Standard deviations from the covariance of free parameters, and from variances that are larger where need be.
LimitedDriveFit::Spread spread_of(const std::vector<int>& free, const Parameters& p, const Eigen::MatrixXd& unlike,
                                  const Eigen::VectorXd& variance) {
  LimitedDriveFit::Spread result{.std = {}, .track_std = 0.0, .to_sides = Eigen::Matrix3d::Zero()};
  constexpr std::array kToSides{0, 1, kTrack};
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const auto at = [&](Eigen::Index k) { return std::ranges::find(free, kToSides.at(static_cast<std::size_t>(k))); };
      if (at(i) != free.end() && at(j) != free.end()) {
        result.to_sides(i, j) = unlike(at(i) - free.begin(), at(j) - free.begin());
      }
    }
  }
  for (Eigen::Index k = 0; k < variance.size(); ++k) {
    const int parameter = free[static_cast<std::size_t>(k)];
    const double std = std::sqrt(std::max(variance[k], 0.0)) * std::exp(p[parameter]);
    if (parameter == kTrack) {
      result.track_std = std;
    } else if (parameter >= kFirstLimit) {
      const auto place = static_cast<std::size_t>(parameter - kFirstLimit);
      result.std.at(place / kPerLane).at(place % kPerLane + 1) = std;
    }
  }
  return result;
}

}  // namespace

LimitedDriveFit::Spread LimitedDriveFit::spread(const LimitedDrive& drive) const {
  const std::vector<int> free = free_parameters(drive);
  const auto size = static_cast<Eigen::Index>(free.size());
  const Residuals r = residuals(drive);
  const Eigen::MatrixXd slope = jacobian(drive, free, r);
  const Parameters p = parameters_of(drive);
  Eigen::MatrixXd bread = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    bread(k, k) = prior_pull(free[static_cast<std::size_t>(k)], p, prior_, track_).precision + 1e-12;
  }
  Eigen::MatrixXd meat = bread;
  Eigen::MatrixXd alone = bread;  // the meat, if no residual knew of another
  const Eigen::Index rows = r.value.rows();
  for (int c = 0; c < kOutputs; ++c) {
    const Eigen::ArrayXd u = r.value.col(c).array() / r.scale[c];
    const Eigen::ArrayXd score = r.weight.col(c).array() * u / r.scale[c];
    const double curvature =
        ((kDof + 1.0) * (kDof - u.square()) / (kDof + u.square()).square()).mean() / (r.scale[c] * r.scale[c]);
    const auto mine = slope.middleRows(c * rows, rows);
    bread += std::max(curvature, 0.0) * mine.transpose() * mine;
    alone += score.square().mean() * mine.transpose() * mine;
    Eigen::Index row = 0;
    for (const DriveRecord& record : records_) {
      const auto end = row + static_cast<Eigen::Index>(record.t.size()) - 1;
      Eigen::VectorXd block = Eigen::VectorXd::Zero(size);
      double block_end = record.t.front() + kSecondsAlike;
      for (std::size_t i = 1; row < end; ++row, ++i) {
        if (record.t[i] > block_end) {
          meat += block * block.transpose();
          block.setZero();
          block_end = record.t[i] + kSecondsAlike;
        }
        block += score[row] * mine.row(row).transpose();
      }
      meat += block * block.transpose();
    }
  }
  const Eigen::MatrixXd inverse = bread.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  // A limit may show in a few stretches alone, which the fit then follows: their residuals are too small to tell.
  const Eigen::MatrixXd unlike = inverse * alone * inverse;
  const Eigen::VectorXd variance = (inverse * meat * inverse).diagonal().cwiseMax(unlike.diagonal());
  return spread_of(free, p, unlike, variance);
}

}  // namespace slipwise
