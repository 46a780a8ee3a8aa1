// SPDX-License-Identifier: Apache-2.0
// The causal filter of one model.
#include "slipwise/filter/causal_filter.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include "slipwise/filter/heavy_tails.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/takes.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kSpeedChange, 0.1);  // the prior follows the speeds when their logarithm moves by more than this

// Weight from which a branch says what is known: the many that were born of late and show nothing hold a jump possible,
// and have tails far beyond a standard deviation.
SLIPWISE_TUNING(kProven, 0.01);
SLIPWISE_TUNING(kExpected, 0.5);   // probability of a jump where something says that the terrain may have changed
SLIPWISE_TUNING(kForgotten, 0.1);  // of the prior variance of slip, given back there where none may jump

SLIPWISE_TUNING(kFirst, 8.0);  // segments after which the first refit begins, and the last
SLIPWISE_TUNING(kLast, std::size_t{256});
SLIPWISE_TUNING(kFactor, std::numbers::sqrt2);  // of the segments, until another begins
constexpr std::size_t kShortest = 1;            // segments that a refit takes at least
constexpr std::size_t kShare = 14;              // slices of it that a segment does at most, some 100 us each

/// Segments after which a refit takes effect that began after so many.
std::size_t refitted_after(std::size_t segments) { return segments + std::max(kShortest, segments / 16); }

bool far_apart(double a, double b) { return std::abs(std::log(a / b)) > kSpeedChange; }

}  // namespace

CausalFilter::CausalFilter(MotionModel model, const CausalFilterSettings& settings)
    : model_(std::move(model)),
      settings_(settings),
      state_(model_, settings.noise),
      noise_before_(settings.noise),
      force_(model_.basis(), settings.force),
      force_at_(std::numeric_limits<double>::infinity()),
      branches_(model_, {.follow = settings.branches.follow && !force_.learned()}) {  // sudden changes count as force
  follow({.v = 1.0, .omega = 1.0});
  started_ = false;
  stated_ = Eigen::VectorXd::Ones(model_.size());
  next_refit_ = kFirst;
}

CausalFilter::CausalFilter() : CausalFilter(MotionModel(), {}) {}
CausalFilter::CausalFilter(const CausalFilter&) = default;
CausalFilter::CausalFilter(CausalFilter&&) noexcept = default;
CausalFilter& CausalFilter::operator=(const CausalFilter&) = default;
CausalFilter& CausalFilter::operator=(CausalFilter&&) noexcept = default;
CausalFilter::~CausalFilter() = default;

Eigen::VectorXd CausalFilter::slip_std_at(const ReferenceSpeeds& speeds) const {
  return force_.prior_std(slip_prior_std(model_.basis(), speeds, settings_.prior));
}

void CausalFilter::follow(const ReferenceSpeeds& speeds) {
  Eigen::VectorXd std = slip_std_at(speeds);
  if (!started_) {
    state_.estimate = before_ = prior(speeds);
    branches_.restart(state_.estimate);
  } else if (far_apart(speeds.v, speeds_.v) || far_apart(speeds.omega, speeds_.omega)) {
    std::optional<Estimate> changed = change_slip_prior(state_.estimate, slip_std_, std);
    std::optional<Estimate> before = change_slip_prior(before_, slip_std_, std);
    if (!changed || !before) {
      return;  // the old prior stays in force
    }
    if (!branches_.change_prior(slip_std_, std)) {
      return;
    }
    state_.estimate = branches_.follow() ? branches_.mixture() : std::move(*changed);
    before_ = std::move(*before);
  } else {
    return;
  }
  started_ = true;
  speeds_ = speeds;
  slip_std_ = std::move(std);
}

Estimate CausalFilter::prior(const ReferenceSpeeds& speeds) const {
  Estimate known = prior_estimate(model_, speeds, settings_.prior);
  force_.pass(known, -1.0);
  return known;
}

/// Slip that explains all motion.
Eigen::VectorXd CausalFilter::unit() const { return slip_prior_std(model_.basis(), speeds_, 1.0); }

Eigen::VectorXd CausalFilter::prior_std() const { return prior(speeds_).covariance.diagonal().cwiseSqrt(); }

/// Time passes for a force from the middle of one segment to that of the next.
void CausalFilter::pass(const Segment& segment) {
  if (force_.learned()) {
    const double middle = 0.5 * (segment.start + segment.end);
    force_.pass(state_.estimate, middle - force_at_);
    force_at_ = middle;
  }
}

void CausalFilter::take(const SlipCue& cue) {
  std::visit(Takes{[this](const ForgetSlip& forgotten) { forget(forgotten.fraction); },
                   [this](const ChangeExpected& /*now*/) { expect_change(); },
                   [this](const SlipLasts& lasting) { lasting_ = lasting.seconds; }},
             cue);
}

void CausalFilter::forget(double fraction) {
  const Eigen::Index slip = model_.slip_size();
  const double keep = std::sqrt(1.0 - fraction);
  Eigen::MatrixXd& covariance = state_.estimate.covariance;
  covariance.topRows(slip) *= keep;
  covariance.leftCols(slip) *= keep;
  covariance.diagonal().head(slip) += fraction * slip_std_.cwiseAbs2();
  state_.noise_scale.reset_gain();
  start_from_here();
}

void CausalFilter::expect_change() {
  if (!branches_.follow()) {
    forget(kForgotten);
    return;
  }
  branches_.expect_jump(prior(speeds_), unit(), kExpected);
  state_.estimate = branches_.mixture();
}

/// The next segments are learned on the present estimate, and fitted again on it.
void CausalFilter::start_from_here() {
  state_.scores.restart();
  stated_.setOnes();
  branches_.restart(state_.estimate);
  start_refits(state_.estimate);
}

void CausalFilter::start_refits(const Estimate& before) {
  before_ = before;
  noise_before_ = state_.noise_scale;
  noise_before_.reset_gain();
  refit_.reset();
  kept_.clear();
  next_refit_ = kFirst;
  full_ = false;
}

SurfaceSlip CausalFilter::surface() const {
  SurfaceSlip surface = surface_of(state_.estimate, stated_, slip_std_, speeds_);
  surface.noise_scale = state_.noise_scale;
  return surface;
}

/// The slip of a surface and the robot as it is known now.
Estimate CausalFilter::on_surface(const SurfaceSlip& surface, double drift) const {
  const Eigen::Index robot = model_.size() - model_.slip_size();
  Estimate joint = joined_with(surface, state_.estimate.mean.tail(robot),
                               state_.estimate.covariance.bottomRightCorner(robot, robot));
  joint.covariance.diagonal().head(model_.slip_size()) += drift * surface.prior_std.cwiseAbs2();
  return joint;
}

void CausalFilter::go_on_with(const SurfaceSlip& surface, double drift) {
  state_.estimate = on_surface(surface, drift);
  state_.noise_scale = surface.noise_scale;
  slip_std_ = surface.prior_std;
  speeds_ = surface.speeds;
  started_ = true;
  start_from_here();
}

void CausalFilter::recall(std::span<const RecalledSlip> known, double drift) {
  if (!branches_.follow() || !started_ || known.empty()) {
    return;
  }
  std::vector<Estimate> estimates;
  Eigen::VectorXd probabilities(std::ssize(known));
  for (std::size_t i = 0; i < known.size(); ++i) {
    const SurfaceSlip& slip = known[i].slip;
    const Estimate learned = on_surface(slip, drift);
    estimates.push_back(change_slip_prior(learned, slip.prior_std, slip_std_).value_or(learned));
    probabilities[static_cast<Eigen::Index>(i)] = known[i].probability;
  }
  branches_.recall(std::move(estimates), probabilities);
  state_.estimate = branches_.mixture();
}

void CausalFilter::know_robot(const Estimate& robot) {
  const Eigen::Index size = std::ssize(robot.mean);
  Eigen::MatrixXd& covariance = state_.estimate.covariance;
  state_.estimate.mean.tail(size) = robot.mean;
  covariance.bottomRows(size).setZero();
  covariance.rightCols(size).setZero();
  covariance.bottomRightCorner(size, size) = robot.covariance;
  branches_.restart(state_.estimate);
}

SurfaceSlip CausalFilter::new_surface(std::span<const SurfaceSlip> known) const {
  const Eigen::Index robot = model_.size() - model_.slip_size();
  SurfaceSlip fresh = shrunk_prior(known, state_.estimate.mean.tail(robot), slip_std_, speeds_);
  fresh.noise_scale = state_.noise_scale;
  fresh.noise_scale.reset_gain();
  return fresh;
}

Estimate CausalFilter::reported() const {
  const bool alone = branches_.size() < 2;
  const Eigen::MatrixXd covariance = alone ? state_.estimate.covariance : branches_.mixture_above(kProven).covariance;
  return {state_.estimate.mean, stated_.asDiagonal() * covariance * stated_.asDiagonal()};
}

/// A parked robot tells nothing of the parameters, and nothing of the noise of driving.
void CausalFilter::keep(const InputHistory& inputs, const Segment& segment) {
  kept_.push_back({.inputs = inputs, .segment = segment});
  const std::size_t count = kept_.size();
  if (refit_) {
    const std::size_t due = refit_->due(count);
    while (refit_->work.slices() < due && refit_->work.advance(kept_)) {
    }
    if (count >= refitted_after(refit_->begun) && refit_->work.done(count) && refit_->work.slices() <= due) {
      end_refit();
    }
  }
  if (count <= kLast && std::ssize(kept_) == std::lround(next_refit_)) {
    next_refit_ *= kFactor;
    refit_.emplace(Refit{
        .work = {model_, before_, noise_before_, state_, settings_, count}, .slip_std = slip_std_, .begun = count});
  }
  if (count >= kLast && !refit_) {
    kept_ = {};
    full_ = true;
  }
}

std::size_t CausalFilter::Refit::due(std::size_t segments) const { return kShare * (segments - begun); }

/// No more than the next segment would do: the refits of other filters have their turn.
bool CausalFilter::refit_slice() {
  return refit_ && refit_->work.slices() < refit_->due(kept_.size() + 1) && refit_->work.advance(kept_);
}

/// All of the refit is done; its prior may have followed the speeds meanwhile.
void CausalFilter::end_refit() {
  Refit& refit = present(refit_);
  std::optional<FilterState> found = std::move(refit.work).result();
  const Eigen::VectorXd slip_std = refit.slip_std;
  refit_.reset();
  if (!found) {
    return;
  }
  if (slip_std != slip_std_) {
    std::optional<Estimate> changed = change_slip_prior(found->estimate, slip_std, slip_std_);
    if (!changed) {
      return;
    }
    found->estimate = std::move(*changed);
  }
  state_ = std::move(*found);
  branches_.correct_leader(state_.estimate);
  if (branches_.follow()) {
    state_.estimate = branches_.mixture();
  }
  refitted_ = true;
}

IekfUpdate CausalFilter::learn(const InputHistory& inputs, const Segment& segment, const ReferenceSpeeds& speeds) {
  follow(speeds);
  pass(segment);
  refitted_ = false;
  IekfUpdate update = branches_.follow() ? follow_branches(inputs, segment)
                                         : state_.learn(model_, inputs, segment, settings_.noise, settings_.iekf);
  // The branch that leads is fitted again over the segments since it came to lead. A refit takes all parameters for
  // constant, which a force is not.
  if (branches_.leader_changed()) {
    start_refits(branches_.leader());
  } else if (!full_ && !force_.learned() && !update.at.by_parameter.isZero(0.0)) {
    keep(inputs, segment);
  }
  if (settings_.noise.adapt) {
    const Estimate& first = branches_.follow() ? prior(speeds_) : before_;
    stated_ = state_.scores.std_factors(first.covariance, state_.estimate.covariance, lasting_);
    // Scores are summed as of what is constant: of a force, which changes, they may tell of more spread, not of less.
    for (const Eigen::Index place : force_.places()) {
      stated_[place] = std::max(stated_[place], 1.0);
    }
  }
  return update;
}

IekfUpdate CausalFilter::follow_branches(const InputHistory& inputs, const Segment& segment) {
  const BranchSegment driven{.inputs = inputs,
                             .segment = segment,
                             .prior = prior(speeds_),
                             .unit = unit(),
                             .speeds = speeds_,
                             .alike = stated_.head(model_.slip_size()).cwiseAbs2().maxCoeff()};
  return branches_.learn(model_, driven, settings_, state_);
}

RowsCovariance prediction_covariance(const SegmentLinearization& at,
                                     const Eigen::Ref<const Eigen::MatrixXd>& parameters, const MotionNoise& shape,
                                     const Eigen::Vector3d& scale) {
  return at.by_parameter * parameters * at.by_parameter.transpose() +
         segment_noise(at.path, at.predicted, shape, scale);
}

}  // namespace slipwise
