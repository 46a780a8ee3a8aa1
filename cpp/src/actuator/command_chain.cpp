// SPDX-License-Identifier: Apache-2.0
// The walk over delayed input changes that turns inputs into drive steps.
#include "slipwise/actuator/command_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "slipwise/actuator/channel_response.hpp"
#include "slipwise/actuator/drive_channel.hpp"
#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

using Row = ChainRow;
using Value = ChainValue;
constexpr Eigen::Index kFixed = -1;
constexpr Eigen::Index kOffset = 4;
constexpr double kNever = std::numeric_limits<double>::infinity();

/// A moment that moves with one of the chain's parameters: later with a delay, earlier with the clock offset.
struct Moment {
  double t;
  Eigen::Index parameter;

  Row slope() const {
    Row row = Row::Zero();
    if (parameter != kFixed) {
      row[parameter] = parameter == kOffset ? -1.0 : 1.0;
    }
    return row;
  }
};

/// The samples of one channel as the drive sees them: delayed.
class DelayedCursor {
 public:
  DelayedCursor(const InputTrack& inputs, double delay, Eigen::Index delay_index, double start, double known_until)
      : inputs_(inputs),
        delay_(delay),
        index_(delay_index),
        next_(inputs.count_until(start - delay)),
        end_(std::max(next_, inputs.count_until(known_until))) {}

  BodyTwist held() const { return next_ == 0 ? BodyTwist{} : inputs_.sample(next_ - 1); }
  bool before_first() const { return next_ == 0; }
  double next_change() const { return next_ < end_ ? inputs_.time(next_) + delay_ : kNever; }
  Moment change_moment() const { return {next_change(), index_}; }
  void advance() { ++next_; }
  std::size_t changes_left() const { return end_ - next_; }

  /// Skips samples before `t` that repeat the one held.
  void skip_repeats(double t) {
    while (next_ > 0 && next_change() < t && inputs_.sample(next_) == held()) {
      ++next_;
    }
  }

 private:
  const InputTrack& inputs_;
  double delay_;
  Eigen::Index index_;
  std::size_t next_;
  std::size_t end_;
};

/// Walks over the delayed input changes of a window, with or without slopes.
class ChainWalk {
 public:
  ChainWalk(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window, bool with_slopes)
      : chain_(chain),
        window_(window),
        with_slopes_(with_slopes),
        speed_(speed_response(chain)),
        turn_(turn_response(chain)),
        start_(moment_of(window.start)),
        end_(moment_of(window.end)),
        chain_start_(window.initial && window.known ? Moment{window.known->until, kFixed} : start_),
        warm_up_(warm_up()),
        cursor_v_(inputs, chain.delay_v, kSpeedPlaces.delay, chain_start_.t - warm_up_, window.end),
        cursor_omega_(inputs, chain.delay_omega, kTurnPlaces.delay, chain_start_.t - warm_up_, window.end),
        v_(speed_, kSpeedPlaces),
        vy_(speed_, kSpeedPlaces),
        omega_(turn_, kTurnPlaces) {
    v_.settle(cursor_v_.held().v);
    vy_.settle(cursor_v_.held().vy);
    omega_.settle(cursor_omega_.held().omega);
  }

  DriveSteps run() {
    DriveSteps result;
    const std::size_t steps = cursor_v_.changes_left() + cursor_omega_.changes_left() + 2;
    result.steps.reserve(steps);
    result.jacobians.reserve(with_slopes_ ? steps : 0);
    if (warm_up_ > 0.0) {
      approach({chain_start_.t - warm_up_, kFixed}, chain_start_);
    }
    if (window_.initial) {
      start_at(cursor_v_, v_, window_.initial->v, &BodyTwist::v);
      start_at(cursor_v_, vy_, window_.initial->vy, &BodyTwist::vy);
      start_at(cursor_omega_, omega_, window_.initial->omega, &BodyTwist::omega);
    }
    if (window_.known && start_.t < chain_start_.t) {
      follow_measured(*window_.known->twist, result);
    } else if (start_.t > chain_start_.t) {
      approach(chain_start_, start_);
    }
    cover(start_.t < chain_start_.t ? chain_start_ : start_, result);
    return result;
  }

 private:
  Moment moment_of(double stamp) const { return {stamp - chain_.clock_offset, kOffset}; }

  /// How long the state at the start hangs on earlier inputs: where the drive was measured, its parts alone do.
  double warm_up() const {
    return window_.initial ? parts_warm_up(speed_, turn_)
                           : kSettledLags * std::max(speed_.longest_lag(), turn_.longest_lag());
  }

  /// The channel where the chain starts, as it was measured.
  static void start_at(const DelayedCursor& cursor, DriveChannel& channel, double measured, double BodyTwist::* part) {
    if (cursor.before_first()) {
      channel.keep(measured);
    } else {
      channel.measured(measured, cursor.held().*part);
    }
  }

  /// Records the drive as it was measured, from the start until the chain takes over.
  void follow_measured(const InputTrack& twist, DriveSteps& out) const {
    const Moment until = chain_start_.t < end_.t ? chain_start_ : end_;
    std::size_t next = twist.count_until(start_.t);
    for (Moment now = start_; now.t < until.t; ++next) {
      const bool last = next >= twist.size() || twist.time(next) >= until.t;
      const Moment then = last ? until : Moment{twist.time(next), kFixed};
      const BodyTwist held = next == 0 ? BodyTwist{} : twist.sample(next - 1);
      const double duration = then.t - now.t;
      const Row slope = then.slope() - now.slope();
      DriveStepJacobian jacobian;
      jacobian << slope, held.v * slope, held.vy * slope, held.omega * slope;
      record({duration, held.v * duration, held.vy * duration, held.omega * duration}, jacobian, out);
      now = then;
    }
  }

  /// Goes from `from` to `until`, which nobody sees: each channel by its own changes.
  void approach(const Moment& from, const Moment& until) {
    approach(cursor_v_, speed_, from, until, std::array{Driven{v_, &BodyTwist::v}, Driven{vy_, &BodyTwist::vy}});
    approach(cursor_omega_, turn_, from, until, std::array{Driven{omega_, &BodyTwist::omega}});
  }

  /// A channel, and the part of the inputs that it follows.
  struct Driven {
    DriveChannel& channel;
    double BodyTwist::* part;
  };

  void approach(DelayedCursor& cursor, const ChannelResponse& response, Moment now, const Moment& until,
                std::span<const Driven> driven) const {
    while (now.t < until.t) {
      cursor.skip_repeats(until.t);
      const Moment next = cursor.next_change() < until.t ? cursor.change_moment() : until;
      const ChannelDecay decay(response, next.t - now.t);
      const Row slope = next.slope() - now.slope();
      for (const auto& [channel, part] : driven) {
        if (with_slopes_) {
          channel.follow(cursor.held().*part, decay, slope);
        } else {
          channel.step(cursor.held().*part, decay);
        }
      }
      if (cursor.next_change() <= next.t) {
        cursor.advance();
        for (const auto& [channel, part] : driven) {
          channel.begin();
        }
      }
      now = next;
    }
  }

  /// Steps from `now` to the end.
  void cover(Moment now, DriveSteps& out) {
    while (now.t < end_.t) {
      const double change = std::min(cursor_v_.next_change(), cursor_omega_.next_change());
      Moment next = end_;
      if (change < end_.t) {
        next = cursor_v_.next_change() <= change ? cursor_v_.change_moment() : cursor_omega_.change_moment();
      }
      subdivide(now, next, out);
      advance_cursors(next.t);
      now = next;
    }
  }

  /// Changes of the two channels are taken one at a time, since they move apart with their delays; without delays,
  /// together.
  void advance_cursors(double t) {
    const bool v_changes = cursor_v_.next_change() <= t;
    const bool omega_changes = cursor_omega_.next_change() <= t;
    const bool together = chain_.delay_v == 0.0 && chain_.delay_omega == 0.0;
    if (v_changes) {
      cursor_v_.advance();
      v_.begin();
      vy_.begin();
    }
    if (omega_changes && (together || !v_changes)) {
      cursor_omega_.advance();
      omega_.begin();
    }
  }

  void subdivide(const Moment& from, const Moment& to, DriveSteps& out) {
    const bool lagging = speed_.longest_lag() > 0.0 || turn_.longest_lag() > 0.0;
    const int parts = lagging ? lag_parts(to.t - from.t, window_.longest_step) : 1;
    const double duration = (to.t - from.t) / parts;
    const ChannelDecay decay_v(speed_, duration);
    const ChannelDecay decay_omega(turn_, duration);
    if (with_slopes_ && (lagging || from.parameter != to.parameter)) {
      const Row slope = (to.slope() - from.slope()) * (1.0 / parts);
      for (int i = 0; i < parts; ++i) {
        DriveStepJacobian jacobian;
        const DriveStep step = linearize_step(decay_v, decay_omega, slope, jacobian);
        record(step, jacobian, out);
      }
      return;
    }
    for (int i = 0; i < parts; ++i) {
      const DriveStep step = next_step(decay_v, decay_omega);
      record(step, with_slopes_ ? gain_slopes(duration) : DriveStepJacobian(), out);
    }
  }

  /// Without lag, and where no duration moves, only the gains tell.
  DriveStepJacobian gain_slopes(double duration) const {
    DriveStepJacobian jacobian = DriveStepJacobian::Zero();
    jacobian(1, kSpeedPlaces.gain) = v_.by_gain(cursor_v_.held().v, duration);
    jacobian(2, kSpeedPlaces.gain) = vy_.by_gain(cursor_v_.held().vy, duration);
    jacobian(3, kTurnPlaces.gain) = omega_.by_gain(cursor_omega_.held().omega, duration);
    return jacobian;
  }

  void record(const DriveStep& step, const DriveStepJacobian& jacobian, DriveSteps& out) const {
    out.steps.push_back(step);
    if (with_slopes_) {
      out.jacobians.push_back(jacobian);
    }
  }

  DriveStep next_step(const ChannelDecay& decay_v, const ChannelDecay& decay_omega) {
    const BodyTwist linear = cursor_v_.held();
    return {decay_v.fast.duration, v_.step(linear.v, decay_v), vy_.step(linear.vy, decay_v),
            omega_.step(cursor_omega_.held().omega, decay_omega)};
  }

  DriveStep linearize_step(const ChannelDecay& decay_v, const ChannelDecay& decay_omega, const Row& duration_slope,
                           DriveStepJacobian& jacobian) {
    const BodyTwist linear = cursor_v_.held();
    const Value forward = v_.linearize_step(linear.v, decay_v, duration_slope);
    const Value left = vy_.linearize_step(linear.vy, decay_v, duration_slope);
    const Value turn = omega_.linearize_step(cursor_omega_.held().omega, decay_omega, duration_slope);
    jacobian << duration_slope, forward.slope, left.slope, turn.slope;
    return {decay_v.fast.duration, forward.value, left.value, turn.value};
  }

  const CommandChain& chain_;
  const DriveWindow& window_;
  bool with_slopes_;
  ChannelResponse speed_;
  ChannelResponse turn_;
  Moment start_;
  Moment end_;
  Moment chain_start_;
  double warm_up_;
  DelayedCursor cursor_v_;
  DelayedCursor cursor_omega_;
  DriveChannel v_, vy_, omega_;
};

}  // namespace

DriveSteps drive_steps(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window) {
  return ChainWalk(inputs, chain, window, false).run();
}

DriveSteps linearize_drive_steps(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window) {
  return ChainWalk(inputs, chain, window, true).run();
}

}  // namespace slipwise
