// SPDX-License-Identifier: Apache-2.0
// The first segments of a filter fitted again all at once, in slices of bounded work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/filter/batch.hpp"
#include "slipwise/filter/causal_filter_settings.hpp"
#include "slipwise/filter/filter_state.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// The first segments were learned with a first guess of the noise, and linearised where little was known. A refit
/// weights them by the estimate once there are more, fits all at once, then learns those that came meanwhile. Where
/// the fit does not converge, what was learned one by one stands.
class FilterRefit {
 public:
  FilterRefit() = default;  ///< nothing to do
  /// `before` and `noise` were known before the first of the segments; `now` after the last of `count`.
  FilterRefit(MotionModel model, Estimate before, NoiseScale noise, FilterState now,
              const CausalFilterSettings& settings, std::size_t count);

  /// Does a slice of the work on `segments`: the first that were kept, and those since. Whether there was any.
  bool advance(std::span<const DrivenSegment> segments);
  /// Slices that were done.
  std::size_t slices() const { return slices_; }
  /// Whether there is no more to do on so many segments.
  bool done(std::size_t segments) const {
    return phase_ == Phase::Failed || (phase_ == Phase::Follow && done_ == segments);
  }
  /// The present estimate; empty if the fit failed.
  std::optional<FilterState> result() &&;

  /// \throws std::invalid_argument where a loaded one does not fit the model, or the segments that are kept.
  void check_loaded(const MotionModel& model, std::size_t kept) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.before_, self.noise_before_, self.state_, self.noise_, self.iekf_, self.count_, self.phase_,
      self.done_);
    a(self.data_, self.at_, self.places_, self.last_, self.search_, self.fitted_, self.slices_);
  }

 private:
  enum class Phase : std::uint8_t { Weight, Search, Noise, Follow, Failed };
  friend constexpr std::size_t enumerators(Phase /*type*/) { return 5; }
  void weight(const DrivenSegment& driven);
  void begin_search();
  void end_search();
  void learn_noise(const DrivenSegment& driven);

  MotionModel model_;
  Estimate before_;
  NoiseScale noise_before_;
  FilterState state_;  ///< at first, by which segments are weighted; then the result
  NoiseSettings noise_;
  IekfSettings iekf_;
  std::size_t count_ = 0;
  Phase phase_ = Phase::Weight;
  std::size_t done_ = 0;  ///< segments of this phase
  std::vector<BatchDatum> data_;
  std::vector<SegmentLinearization> at_;  ///< the data, at what was known
  std::vector<std::size_t> places_;       ///< of the data among the segments
  std::optional<Segment> last_;           ///< datum, whose neighbour shares the noise of a pose with it
  std::optional<BatchSearch> search_;
  std::size_t fitted_ = 0;  ///< data whose noise is learned
  std::size_t slices_ = 0;
};

}  // namespace slipwise
