// SPDX-License-Identifier: Apache-2.0
// Passes over all windows, a window at a time.
#include "slipwise/estimate/channel_refit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kSlice = 24;                // windows that are walked over at a time
SLIPWISE_TUNING(kConverged, 0.1);                 // [standard deviations] a step that is not worth a pass
constexpr std::array kShortened{1.0, 0.5, 0.25};  // fractions of a step, until one helps
SLIPWISE_TUNING(kTolerance, 0.1);                 // what a step has to gain of -2 log posterior
SLIPWISE_TUNING(kMostPasses, 12);                 // with more windows it goes on from there
SLIPWISE_TUNING(kMostElsewhere, 10);              // the same from a start elsewhere
constexpr Eigen::Index kLag = 0, kSlowShare = 3, kSlowLag = 4;
SLIPWISE_TUNING(kApart, 1.4);  // in the logarithm: time constants closer than that may pass for each other

/// All in one lag, and a slower one beside it.
ChannelParameters without_slow_mode(ChannelParameters chain) {
  const double share = chain[kSlowShare];
  const double lag = (1.0 - share) * std::exp(chain[kLag]) + share * std::exp(chain[kSlowLag]);
  chain[kLag] = lag > 0.0 ? std::log(lag) : chain[kLag];
  chain[kSlowShare] = 0.0;
  chain[kSlowLag] = chain[kLag] + kApart;
  return chain;
}

}  // namespace

ChannelFit::ChannelFit(std::shared_ptr<const ChannelModel> model, double size, ChannelParameters start, int most_passes)
    : model_(std::move(model)),
      size_(size),
      left_(most_passes),
      point_(std::move(start)),
      full_(ChannelParameters::Zero()) {
  try_step();
}

void ChannelFit::try_step() {
  walk_.emplace(model_, size_, best_ ? point_ + kShortened[shortened_] * full_ : point_);
  done_ = 0;
  --left_;
}

/// A step from the best point, unless there are no passes left or the step is not worth one.
void ChannelFit::next_step() {
  walk_.reset();
  full_ = best().joint.mean.head<kChannelParameters>() - point_;
  const ChannelParameters std = best().joint.covariance.diagonal().head<kChannelParameters>().cwiseSqrt();
  shortened_ = 0;
  if (left_ > 0 && (full_.cwiseAbs() - kConverged * std).maxCoeff() > 0.0) {
    try_step();
  }
}

void ChannelFit::judge(ChainPass pass) {
  if (!best_) {
    best_ = std::move(pass);
    next_step();
    return;
  }
  const double gained = best_->cost - pass.cost;
  if (gained > 0.0) {
    point_ += kShortened[shortened_] * full_;
    best_ = std::move(pass);
    if (gained >= kTolerance) {
      next_step();
    } else {
      walk_.reset();
    }
    return;
  }
  ++shortened_;
  if (left_ > 0 && shortened_ < kShortened.size()) {
    try_step();
  } else {
    walk_.reset();
  }
}

bool ChannelFit::advance(std::span<const ChannelWindow> past) {
  if (!walk_) {
    return false;
  }
  for (const std::size_t end = std::min(done_ + kSlice, past.size()); done_ < end; ++done_) {
    present(walk_).learn(past[done_]);
  }
  if (done_ == past.size()) {
    judge(present(walk_).result());
  }
  return walk_.has_value();
}

ChannelRefit::ChannelRefit(const ChainChannel& channel, std::size_t count)
    : channel_(channel),
      model_(std::make_shared<const ChannelModel>(channel.model())),
      size_(channel.noise_variance()),
      count_(count),
      done_(count) {
  fit_.emplace(model_, size_, channel.estimate().mean, kMostPasses);
}

/// Two lags that pass for each other may hide a better fit with one.
void ChannelRefit::end_fit() {
  ChainPass best = present(fit_).best();
  fit_.reset();
  if (!first_) {
    const ChannelParameters found = best.joint.mean.head<kChannelParameters>();
    if (found[kSlowLag] < found[kLag] + kApart) {
      first_ = std::move(best);
      fit_.emplace(model_, size_, without_slow_mode(found), kMostElsewhere);
      return;
    }
  } else if (!(best.cost < first_->cost)) {
    best = std::move(*first_);
  }
  channel_.take(std::move(best));
}

bool ChannelRefit::advance(std::span<const ChannelWindow> past) {
  if (fit_) {
    if (!fit_->advance(past.first(count_))) {
      end_fit();
    }
    return fit_ || done_ < past.size();
  }
  if (done_ < past.size()) {
    channel_.learn(past[done_++]);
  }
  return done_ < past.size();
}

}  // namespace slipwise
