// SPDX-License-Identifier: Apache-2.0
// Walks over all windows, a slice at a time.
#include "slipwise/identify/channel_refit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kSlice = 96;    // windows that are walked over at a time,
constexpr std::size_t kFollowed = 4;  // or learned
SLIPWISE_TUNING(kTolerance, 0.1);     // what a step has to gain of -2 log posterior
SLIPWISE_TUNING(kMostPasses, 12);     // with more windows it goes on from there
SLIPWISE_TUNING(kMostElsewhere, 10);  // the same from a start elsewhere
SLIPWISE_TUNING(kApart, 1.4);         // in the logarithm: time constants closer than that may pass for each other

/// All in one lag, and a slower one beside it.
ChannelParameters without_slow_mode(ChannelParameters actuator) {
  const double fraction = actuator[kSlowFraction];
  const double lag =
      (1.0 - fraction) * std::exp(actuator[kTimeConstant]) + fraction * std::exp(actuator[kSlowTimeConstant]);
  actuator[kTimeConstant] = lag > 0.0 ? std::log(lag) : actuator[kTimeConstant];
  actuator[kSlowFraction] = 0.0;
  actuator[kSlowTimeConstant] = actuator[kTimeConstant] + kApart;
  return actuator;
}

}  // namespace

ChannelFit::ChannelFit(std::shared_ptr<const ChannelModel> model, double size, const ChannelParameters& start,
                       int most_passes)
    : model_(std::move(model)),
      size_(size),
      search_(start, {.iterations = most_passes - 1, .absolute = kTolerance}),
      walk_(std::in_place, model_, size_, start) {}

/// A walk over all windows at the candidate.
void ChannelFit::judge(const ChannelFilter& walk) {
  if (search_.judge(walk.cost())) {
    best_ = walk.result();
    at_best_ = walk.equations();
  }
  search_.propose(at_best_);
}

bool ChannelFit::advance(std::span<const ChannelWindow> past) {
  if (!walk_) {
    return false;
  }
  for (const std::size_t end = std::min(done_ + kSlice, past.size()); done_ < end; ++done_) {
    present(walk_).learn(past[done_]);
  }
  if (done_ == past.size()) {
    judge(present(walk_));
    walk_.reset();
    if (!search_.over()) {
      walk_.emplace(model_, size_, search_.candidate());
      done_ = 0;
    }
  }
  return walk_.has_value();
}

ChannelRefit::ChannelRefit(const ActuatorChannel& channel, std::size_t count)
    : channel_(channel),
      model_(std::make_shared<const ChannelModel>(channel.model())),
      size_(channel.noise_variance()),
      count_(count),
      done_(count) {
  fit_.emplace(model_, size_, channel.estimate().mean, kMostPasses);
}

/// Two lags that pass for each other may hide a better fit with one.
void ChannelRefit::end_fit() {
  ChannelRun best = present(fit_).best();
  fit_.reset();
  if (!first_) {
    const ChannelParameters found = best.joint.mean.head<kChannelParameters>();
    if (found[kSlowTimeConstant] < found[kTimeConstant] + kApart) {
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
    return true;
  }
  const bool more = done_ < past.size();
  for (const std::size_t end = std::min(done_ + kFollowed, past.size()); done_ < end; ++done_) {
    channel_.learn(past[done_]);
  }
  return more;
}

}  // namespace slipwise
