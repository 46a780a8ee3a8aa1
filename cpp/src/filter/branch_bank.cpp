// SPDX-License-Identifier: Apache-2.0
// Births of branches, their weights, and one update of all of them.
#include "slipwise/filter/branch_bank.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/carried_linearization.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kMotion, 800.0);                   // [s] of motion from one jump to the next, on average
SLIPWISE_TUNING(kMost, std::size_t{8});            // branches that are kept
constexpr std::array kSizes{0.1, 0.35};            // standard deviations of jumps, as fractions of the motion
SLIPWISE_TUNING(kMinor, 0.1);                      // as large are those of the other terms of a channel
SLIPWISE_TUNING(kShape, 2.0);                      // of the size, the part of slip as it was that a jump adds or takes
SLIPWISE_TUNING(kForgetting, 0.05);                // for each jump, births in which all slip is forgotten
SLIPWISE_TUNING(kForgetAfter, std::size_t{20});    // segments before the first of them
SLIPWISE_TUNING(kMoves, 0.02);                     // of the reference speeds; slower robots are parked
constexpr double kSureWeight = 0.9;                // of the weight; so much counts as another terrain at once
constexpr double kAlmostAll = 1.0 - 1e-12;         // of the weight, whose odds are finite
SLIPWISE_TUNING(kTempered, 0.5);                   // power of the number of segments that count as one
SLIPWISE_TUNING(kAlikeSegments, std::size_t{16});  // segments ago, when slip had not changed yet that does so now

/// The slip of one channel, by the size of its terms' jumps where the channel's most is 1.
JumpingChannel jumping(const Basis& basis, Channel channel, std::string_view main) {
  JumpingChannel found;
  for (std::size_t i = basis.begin(channel); i < basis.end(channel); ++i) {
    const bool is_main = basis.parameter_name(i) == main;
    found.terms.push_back(static_cast<Eigen::Index>(i));
    found.sizes.push_back(is_main ? 1.0 : kMinor);
    found.has_main = found.has_main || is_main;
  }
  return found;
}

/// How much a segment counts whose neighbours err alike.
double part_of_alike(double alike) { return std::pow(std::max(alike, 1.0), -kTempered); }

/// Seconds of motion at the reference speeds.
double seconds_of_motion(const SegmentPath& path, const ReferenceSpeeds& speeds) {
  double seconds = 0.0;
  for (const ActuatorStep& step : path.drive) {
    const double fast = std::hypot(step.forward, step.left) / speeds.v + std::abs(step.turn) / speeds.omega;
    seconds += std::min(fast, step.duration);
  }
  return seconds;
}

/// Mean and covariance of a mixture.
Estimate merged(const std::vector<Branch>& branches, const Eigen::VectorXd& weights) {
  if (branches.size() == 1) {
    return branches.front().estimate;
  }
  const Eigen::Index size = branches.front().estimate.mean.size();
  Estimate all{Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, size)};
  for (std::size_t i = 0; i < branches.size(); ++i) {
    all.mean += weights[static_cast<Eigen::Index>(i)] * branches[i].estimate.mean;
  }
  for (std::size_t i = 0; i < branches.size(); ++i) {
    const Eigen::VectorXd away = branches[i].estimate.mean - all.mean;
    all.covariance +=
        weights[static_cast<Eigen::Index>(i)] * (branches[i].estimate.covariance + away * away.transpose());
  }
  return all;
}

/// Each channel may jump in its terms, and in proportion to what it was: ground that is more slippery in one term is so
/// in all of them.
Estimate after_jump(Estimate known, const JumpKind& kind, double size, const Eigen::VectorXd& unit) {
  for (const JumpingChannel& channel : kind) {
    const Eigen::VectorXd shape = kShape * size * known.mean(channel.terms);
    known.covariance(channel.terms, channel.terms) += shape * shape.transpose();
    for (std::size_t i = 0; i < channel.terms.size(); ++i) {
      const Eigen::Index term = channel.terms[i];
      known.covariance(term, term) += std::pow(size * channel.sizes[i] * unit[term], 2);
    }
  }
  return known;
}

/// Slip is as before any data; what is the robot's is as the mixture knows it.
Estimate forgotten(const Estimate& known, const Estimate& prior, Eigen::Index slip) {
  const Eigen::Index robot = known.mean.size() - slip;
  Estimate all = prior;
  all.mean.tail(robot) = known.mean.tail(robot);
  all.covariance.bottomRightCorner(robot, robot) = known.covariance.bottomRightCorner(robot, robot);
  return all;
}

/// What was measured, and its noise.
struct MeasuredRows {
  Rows value;
  const RowsCovariance& noise;
};

/// One branch, by the linearisation that all share; a residual counts as by the rule of the IEKF.
void update_branch(const MotionModel& model, Estimate& known, const IekfUpdate& shared, const MeasuredRows& measured,
                   const IekfSettings& settings) {
  const auto& by_parameter = shared.at.by_parameter;
  const Rows left = measured.value - shared.at.predicted - by_parameter * (known.mean - shared.estimate.mean);
  const double nis = normalised_square(left, innovation_covariance(known.covariance, by_parameter, measured.noise));
  const double weight = settings.weight(nis);
  if (weight == 0.0) {
    return;
  }
  const RowsCovariance weighted = measured.noise / weight;
  const Estimate before = known;
  known.mean += linear_update(known.covariance, by_parameter, weighted) * left;
  if (!shared.bent.isZero(0.0)) {
    known.covariance = before.covariance;
    linear_update(known.covariance, by_parameter, weighted + shared.bent);
  }
  follow_times(model, before.mean, known);
}

SegmentLinearization moved(SegmentLinearization at, const Eigen::VectorXd& step) {
  at.predicted += at.by_parameter * step;
  return at;
}

}  // namespace

BranchBank::BranchBank(const MotionModel& model, const BranchSettings& settings) : settings_(settings) {
  if (!settings.follow) {
    return;
  }
  const JumpingChannel yaw = jumping(model.basis(), Channel::Ang, "ang.w");
  const JumpingChannel forward = jumping(model.basis(), Channel::Lon, "lon.V");
  if (yaw.has_main) {
    kinds_.push_back({yaw});
  }
  if (forward.has_main) {
    kinds_.push_back({forward});
  }
  if (kinds_.size() > 1) {
    kinds_.push_back({yaw, forward, jumping(model.basis(), Channel::Lat, "lat.V*w")});
  }
}

Estimate BranchBank::mixture() const { return merged(branches_.keys(), branches_.weights()); }

Estimate BranchBank::mixture_above(double weight) const {
  const Eigen::VectorXd heavy = (branches_.weights().array() < weight).select(0.0, branches_.weights());
  return merged(branches_.keys(), heavy / heavy.sum());
}

void BranchBank::restart(const Estimate& known) {
  if (!follow()) {
    return;
  }
  branches_ = {};
  branches_.add({.estimate = known, .number = ++births_, .born = segments_}, 1.0);
  led_by_ = known_ = births_;
  held_ = 0;
  alike_.clear();
  change_ = {};
  leader_changed_ = false;
}

void BranchBank::correct_leader(const Estimate& better) {
  const auto led_by = std::ranges::find(branches_.keys(), led_by_, &Branch::number);
  if (led_by != branches_.keys().end()) {
    led_by->estimate = better;
  }
}

bool BranchBank::change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std) {
  if (!follow()) {
    return true;
  }
  Estimate& leader = branches_[branches_.heaviest()].estimate;
  const auto better = change_slip_prior(leader, old_std, new_std);
  if (!better) {
    return false;
  }
  for (Branch& branch : branches_.keys()) {
    if (auto changed = &branch.estimate == &leader ? better : change_slip_prior(branch.estimate, old_std, new_std)) {
      branch.estimate = std::move(*changed);
    }
  }
  return true;
}

/// Once, until something is learned.
void BranchBank::expect_jump(const Estimate& prior, const Eigen::VectorXd& unit, double probability) {
  const auto just_born = [&](const Branch& branch) { return branch.born == segments_ && branch.number > known_; };
  if (std::ranges::any_of(branches_.keys(), just_born)) {
    return;
  }
  bear(prior, unit, probability);
  branches_.weigh(Eigen::VectorXd::Zero(branches_.weights().size()));
  prune();
}

void BranchBank::recall(std::vector<Estimate> known, const Eigen::VectorXd& probabilities) {
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < branches_.size(); ++i) {
    if (branches_[i].born < segments_ || branches_[i].number <= recalled_ || recalled_ == 0) {
      others.push_back(i);
    }
  }
  branches_ = branches_.chosen(others);
  recalled_ = births_;
  const double before = branches_.log_evidence();
  branches_.weigh(
      Eigen::VectorXd::Constant(branches_.weights().size(), std::log1p(-std::min(probabilities.sum(), kAlmostAll))));
  for (std::size_t i = 0; i < known.size(); ++i) {
    branches_.add({.estimate = std::move(known[i]), .number = ++births_, .born = segments_}, 0.0,
                  before + std::log(probabilities[static_cast<Eigen::Index>(i)]));
  }
  branches_.weigh(Eigen::VectorXd::Zero(branches_.weights().size()));
  known_ = births_;
}

std::vector<Estimate> BranchBank::jumps(const Estimate& known, const Eigen::VectorXd& unit) const {
  std::vector<Estimate> all;
  for (const JumpKind& kind : kinds_) {
    for (const double size : kSizes) {
      all.push_back(after_jump(known, kind, size, unit));
    }
  }
  return all;
}

/// With this probability, slip jumped just before the next segment.
void BranchBank::bear(const Estimate& prior, const Eigen::VectorXd& unit, double hazard) {
  const Estimate now = mixture();
  const double jumped = branches_.log_evidence() + std::log(hazard);
  branches_.weigh(Eigen::VectorXd::Constant(branches_.weights().size(), std::log1p(-hazard)));
  std::vector<Estimate> all = jumps(now, unit);
  const double share = std::log(static_cast<double>(all.size()));
  for (Estimate& each : all) {
    branches_.add({.estimate = std::move(each), .number = ++births_, .born = segments_}, 0.0, jumped - share);
  }
  if (segments_ >= kForgetAfter) {
    branches_.add({.estimate = forgotten(now, prior, unit.size()), .number = ++births_, .born = segments_}, 0.0,
                  jumped + std::log(kForgetting));
  }
}

void BranchBank::prune() {
  std::vector<std::size_t> places(branches_.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  if (places.size() > kMost) {
    const auto heavier = [&](std::size_t a, std::size_t b) {
      return branches_.weights()[static_cast<Eigen::Index>(a)] > branches_.weights()[static_cast<Eigen::Index>(b)];
    };
    std::ranges::stable_sort(places, heavier);
    places.resize(kMost);
    std::ranges::sort(places);
  }
  branches_ = branches_.chosen(places);
  branches_.weigh(Eigen::VectorXd::Zero(branches_.weights().size()));
}

/// Of the branches that were born after so many.
double BranchBank::weight_after(std::size_t births) const {
  double weight = 0.0;
  for (std::size_t i = 0; i < branches_.size(); ++i) {
    weight += branches_[i].number > births ? branches_.weights()[static_cast<Eigen::Index>(i)] : 0.0;
  }
  return weight;
}

/// Branches that were born within a few segments of one jump share the weight, and none may ever hold half of it.
void BranchBank::follow_leader() {
  const std::size_t heaviest = branches_.heaviest();
  const Eigen::VectorXd& weights = branches_.weights();
  const bool leads = weights[static_cast<Eigen::Index>(heaviest)] > 0.5 || weight_after(led_by_) > 0.5;
  leader_changed_ = leads && branches_[heaviest].number != led_by_;
  led_by_ = leads ? branches_[heaviest].number : led_by_;
}

/// By the branches that were born since it counted as changed last.
SlipChange BranchBank::look_for_change() {
  const double young = weight_after(known_);
  if (young <= 0.5) {
    held_ = 0;
    return {};
  }
  double most = 0.0;
  std::size_t born = segments_;
  for (std::size_t i = 0; i < branches_.size(); ++i) {
    const double weight = branches_.weights()[static_cast<Eigen::Index>(i)];
    if (branches_[i].number > known_ && weight > most) {
      born = branches_[i].born;
      most = weight;
    }
  }
  ++held_;
  const SlipChange change{.log_odds = std::log(young) - std::log1p(-std::min(young, kAlmostAll)),
                          .segments = static_cast<int>(segments_ - born),
                          .alarm = held_ == kHeld || young > kSureWeight};
  if (change.alarm) {
    known_ = births_;
    held_ = 0;
  }
  return change;
}

/// While slip changes, neighbours err alike before a branch has it. Whether they go on to is not known yet: what shows
/// now and what showed before counts half each.
double BranchBank::alike_of_late(double alike) {
  alike_.push_back(alike);
  if (alike_.size() <= kAlikeSegments) {
    return alike;
  }
  const double earlier = alike_.front();
  alike_.erase(alike_.begin());
  return std::min(alike, std::sqrt(alike * earlier));
}

/// By the linearisation at `mean`, where the residual is `innovation`. Neighbours that err alike count for less.
void BranchBank::weigh(const SegmentLinearization& at, const Eigen::VectorXd& mean, const Rows& innovation,
                       const RowsCovariance& noise, double alike) {
  const double rate = part_of_alike(alike);
  Eigen::VectorXd scores(branches_.weights().size());
  for (std::size_t i = 0; i < branches_.size(); ++i) {
    const Estimate& known = branches_[i].estimate;
    const Rows left = innovation - at.by_parameter * (known.mean - mean);
    const RowsCovariance spread = innovation_covariance(known.covariance, at.by_parameter, noise);
    scores[static_cast<Eigen::Index>(i)] = rate * student_log_score(normalised_square(left, spread), spread);
  }
  branches_.weigh(scores);
}

/// The most probable mean of the mixture is where all branches are updated.
IekfUpdate BranchBank::update_all(const MotionModel& model, const BranchSegment& driven, SegmentLinearization at,
                                  const RowsCovariance& noise, const IekfSettings& settings) {
  IekfUpdate update = iekf_update(model, mixture(), driven.inputs, driven.segment, std::move(at), noise, settings);
  if (branches_.size() == 1) {
    branches_[0].estimate = update.estimate;
    return update;
  }
  if (update.weight == 0.0) {
    return update;
  }
  for (Branch& branch : branches_.keys()) {
    update_branch(model, branch.estimate, update, {.value = rows_of(driven.segment.measured), .noise = noise},
                  settings);
  }
  const Eigen::VectorXd found = update.estimate.mean;
  update.estimate = mixture();
  update.at = moved(std::move(update.at), update.estimate.mean - found);
  return update;
}

IekfUpdate BranchBank::learn(const MotionModel& model, const BranchSegment& driven,
                             const CausalFilterSettings& settings, FilterState& state) {
  const Segment& segment = driven.segment;
  const Eigen::VectorXd mean = state.estimate.mean;
  auto at = linearize_segment(model, mean, driven.inputs, segment);
  const RowsCovariance expected = expected_noise(at.path, rows_of(segment.measured), settings.noise.shape);
  const RowsCovariance noise = scaled_covariance(expected, scale_for(at.path, state.noise_scale.value()));
  const Rows innovation = error_of(segment, at);
  const RowsCovariance covariance = innovation_covariance(state.estimate.covariance, at.by_parameter, noise);
  const double motion = seconds_of_motion(at.path, driven.speeds);
  const double alike = alike_of_late(driven.alike);
  if (motion > kMoves * (segment.end - segment.start)) {  // slip that lasts is no jump
    bear(driven.prior, driven.unit, -std::expm1(-motion / kMotion * part_of_alike(alike)));
  }
  ++segments_;
  weigh(at, mean, innovation, noise, alike);
  prune();
  const Eigen::VectorXd found = mixture().mean;
  if (found != mean) {
    auto straight = carried(at, model, found - mean, noise);
    at = straight ? std::move(*straight) : linearize_segment(model, found, driven.inputs, segment);
  }
  IekfUpdate update = update_all(model, driven, std::move(at), noise, settings.iekf);
  state.take(update, segment, {.expected = expected, .scaled = noise});
  update.innovation = innovation;
  update.innovation_covariance = covariance;
  update.nis = normalised_square(innovation, covariance);
  follow_leader();
  change_ = look_for_change();
  return update;
}

}  // namespace slipwise
