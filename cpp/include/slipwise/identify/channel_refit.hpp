// SPDX-License-Identifier: Apache-2.0
// All windows of a channel fitted again at once, in slices of bounded work.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "slipwise/identify/actuator_channel.hpp"
#include "slipwise/identify/channel_run.hpp"
#include "slipwise/linear/gauss_newton.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {

/// From a start to the parameters that all windows lead to together. Time constant and delay zigzag towards it, and
/// more is gained by the next windows than by the last steps.
class ChannelFit {
 public:
  ChannelFit() = default;  ///< nothing to do
  ChannelFit(std::shared_ptr<const ChannelModel> model, double size, const ChannelParameters& start, int most_passes);

  /// Learns one window of a pass; whether there is more to do.
  bool advance(std::span<const ChannelWindow> past);
  const ChannelRun& best() const { return present(best_); }

  /// \throws std::invalid_argument where a loaded one is none of the channel `made` and so many windows.
  void check_loaded(const ActuatorChannel& made, std::size_t past) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.size_, self.search_, self.at_best_, self.best_, self.walk_, self.done_);
  }

 private:
  void judge(const ChannelFilter& walk);

  std::shared_ptr<const ChannelModel> model_;
  double size_ = 0.0;
  GaussNewton search_;
  NormalEquations at_best_;
  std::optional<ChannelRun> best_;
  std::optional<ChannelFilter> walk_;  ///< at the candidate
  std::size_t done_ = 0;               ///< windows of the walk
};

/// Windows are first learned one by one, linearised where little was known. A refit learns all of them together, then
/// those that came meanwhile.
class ChannelRefit {
 public:
  ChannelRefit() = default;  ///< nothing to do
  /// `count` windows have been learned by `channel`.
  ChannelRefit(const ActuatorChannel& channel, std::size_t count);

  /// Does a slice of the work on `past` windows: the first, and those since. Whether there was any.
  bool advance(std::span<const ChannelWindow> past);
  /// The estimate after all windows; the refit must have no more to do.
  const ActuatorChannel& result() const { return channel_; }

  /// \throws std::invalid_argument where a loaded one is none of the channel `made` and so many windows.
  void check_loaded(const ActuatorChannel& made, std::size_t past) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.channel_, self.model_, self.size_, self.count_, self.fit_, self.first_, self.done_);
  }

 private:
  void end_fit();

  ActuatorChannel channel_;
  std::shared_ptr<const ChannelModel> model_;  ///< copies of the refit share it
  double size_ = 0.0;
  std::size_t count_ = 0;
  std::optional<ChannelFit> fit_;
  std::optional<ChannelRun> first_;  ///< where a second fit, without a slow mode, is compared with it
  std::size_t done_ = 0;             ///< windows learned by the channel after the fit
};

}  // namespace slipwise
