// SPDX-License-Identifier: Apache-2.0
// A walk of one lane over delayed input changes and the edges of intervals.
#include "slipwise/actuator/lane_motion.hpp"

#include "slipwise/actuator/sensitive_lag.hpp"

namespace slipwise {
namespace {

constexpr ChannelPlaces kPlaces{.lag = 0, .delay = 1, .gain = 2, .slow_share = 3, .slow_lag = 4};
constexpr Eigen::Index kFast = 5;
constexpr Eigen::Index kSlow = 6;

/// With slopes by N parameters: all, or none.
template <int N>
class LaneWalk {
 public:
  using Value = Sensitive<N>;
  using Row = Eigen::Matrix<double, 1, N>;

  LaneWalk(const InputTrack& inputs, const ActuatorAxis& lane, const LaneState& start, double time)
      : inputs_(inputs), lane_(lane), now_(time), next_(inputs.count_until(time - lane.delay)) {
    fast_.value = start.fast;
    slow_.value = start.slow;
    if constexpr (N > 0) {
      fast_.slope[kFast] = 1.0;
      slow_.slope[kSlow] = 1.0;
    }
    hold();
  }

  /// Goes on to `time`; returns the mean until there.
  Value mean_until(double time) {
    const double begun = now_;
    integral_ = {};
    for (; next_ < inputs_.size() && inputs_.time(next_) + lane_.delay < time; ++next_) {
      if (inputs_.sample(next_).*lane_.part != held_) {
        go_to(inputs_.time(next_) + lane_.delay, 1.0);
        held_ = inputs_.sample(next_).*lane_.part;
        aim();
      }
    }
    go_to(time, 0.0);
    integral_.value /= time - begun;
    integral_.slope /= time - begun;
    return integral_;
  }

  const Value& fast() const { return fast_; }
  const Value& slow() const { return slow_; }

 private:
  void hold() {
    held_ = next_ == 0 ? 0.0 : inputs_.sample(next_ - 1).*lane_.part;
    aim();
  }
  void aim() {
    towards_fast_ = part_of<N>(held_, lane_.response, kPlaces, false);
    towards_slow_ = part_of<N>(held_, lane_.response, kPlaces, true);
  }

  static Row by_delay(double moves) {
    if constexpr (N > 0) {
      return moves * Row::Unit(kPlaces.delay);
    } else {
      return {};
    }
  }

  /// A moment that moves with the delay, or stays.
  void go_to(double then, double moves) {
    const Row duration_slope = by_delay(moves - moves_);
    const double duration = then - now_;
    const Value fast =
        advance(fast_, towards_fast_, LagDecay(lane_.response.lag, duration), kPlaces.lag, duration_slope);
    const Value slow =
        advance(slow_, towards_slow_, LagDecay(lane_.response.slow_lag, duration), kPlaces.slow_lag, duration_slope);
    integral_.value += fast.value + slow.value;
    integral_.slope += fast.slope + slow.slope;
    now_ = then;
    moves_ = moves;
  }

  const InputTrack& inputs_;
  const ActuatorAxis& lane_;
  double now_;
  double moves_ = 0.0;
  std::size_t next_;
  double held_ = 0.0;
  Value fast_, slow_, towards_fast_, towards_slow_, integral_;
};

/// Hands `record` each interval's mean, and then both parts at the end.
template <int N, typename Record>
void walk_lane(const InputTrack& inputs, const ActuatorAxis& lane, const LaneState& start,
               std::span<const double> edges, Record record) {
  LaneWalk<N> walk(inputs, lane, start, edges.front());
  const auto intervals = std::ssize(edges) - 1;
  for (std::ptrdiff_t k = 0; k < intervals; ++k) {
    record(k, walk.mean_until(edges[static_cast<std::size_t>(k + 1)]));
  }
  record(intervals, walk.fast());
  record(intervals + 1, walk.slow());
}

}  // namespace

LaneState settled_lane(const InputTrack& inputs, const ActuatorAxis& lane, double time) {
  const double input = inputs.at(time - lane.delay).*lane.part;
  return {lane.response.fast_share() * input, lane.response.share() * lane.response.gain * input};
}

LaneMotion lane_motion(const InputTrack& inputs, const ActuatorAxis& lane, const LaneState& start,
                       std::span<const double> edges) {
  const auto rows = std::ssize(edges) + 1;
  LaneMotion motion{Eigen::VectorXd(rows),
                    Eigen::Matrix<double, Eigen::Dynamic, kLaneParameters>(rows, kLaneParameters)};
  walk_lane<kLaneParameters>(inputs, lane, start, edges, [&motion](Eigen::Index row, const auto& value) {
    motion.value[row] = value.value;
    motion.slope.row(row) = value.slope;
  });
  return motion;
}

Eigen::VectorXd lane_values(const InputTrack& inputs, const ActuatorAxis& lane, const LaneState& start,
                            std::span<const double> edges) {
  Eigen::VectorXd values(std::ssize(edges) + 1);
  walk_lane<0>(inputs, lane, start, edges,
               [&values](Eigen::Index row, const auto& value) { values[row] = value.value; });
  return values;
}

}  // namespace slipwise
