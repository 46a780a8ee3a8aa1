// SPDX-License-Identifier: Apache-2.0
// All windows of a channel fitted again at once, in slices of bounded work.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "slipwise/estimate/chain_channel.hpp"
#include "slipwise/estimate/chain_pass.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {

/// From a start to the parameters that all windows lead to together: Gauss-Newton, whose steps are shortened until they
/// help. Time constant and delay zigzag towards it, and more is gained by the next windows than by the last steps.
class ChannelFit {
 public:
  /// `model` must outlive the fit.
  ChannelFit(const ChannelModel& model, double size, ChannelParameters start, int most_passes);

  /// Learns one window of a pass; whether there is more to do.
  bool advance(std::span<const ChannelWindow> past);
  const ChainPass& best() const { return present(best_); }

 private:
  void judge(ChainPass pass);
  void next_step();
  void try_step();

  const ChannelModel* model_;
  double size_;
  int left_;                 ///< passes
  ChannelParameters point_;  ///< of the best pass
  ChannelParameters full_;   ///< the step from there
  std::size_t shortened_ = 0;
  std::optional<ChainPass> best_;
  std::optional<ChannelWalk> walk_;
  std::size_t done_ = 0;  ///< windows of the walk
};

/// Windows are first learned one by one, linearised where little was known. A refit learns all of them together, then
/// those that came meanwhile.
class ChannelRefit {
 public:
  /// `count` windows have been learned by `channel`.
  ChannelRefit(const ChainChannel& channel, std::size_t count);

  /// Does a slice of the work on `past` windows: the first, and those since. Whether there is more to do now.
  bool advance(std::span<const ChannelWindow> past);
  /// What is known after all windows; the refit must have no more to do.
  const ChainChannel& result() const { return channel_; }

 private:
  void end_fit();

  ChainChannel channel_;
  std::shared_ptr<const ChannelModel> model_;  ///< copies of the refit share it
  double size_;
  std::size_t count_;
  std::optional<ChannelFit> fit_;
  std::optional<ChainPass> first_;  ///< where a second fit, without a slow mode, is compared with it
  std::size_t done_;                ///< windows learned by the channel after the fit
};

}  // namespace slipwise
