// SPDX-License-Identifier: Apache-2.0
// A model average that remembers its last segments, by which surfaces are compared.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <utility>

#include "slipwise/hypotheses/model_average.hpp"
#include "slipwise/hypotheses/surface_evidence.hpp"
#include "slipwise/hypotheses/surface_memory.hpp"
#include "slipwise/motion/disturbance_model.hpp"

namespace slipwise {

/// Segments are kept where surfaces are remembered (`SurfaceSettings`).
class RememberingAverage {
 public:
  /// One of the last segments, and what was known before it.
  struct Recent {
    InputHistory inputs;
    Segment segment;
    SurfaceMemory memory;
    AverageState state;
  };

  RememberingAverage() = default;
  explicit RememberingAverage(ModelAverage average) : average_(std::move(average)) {}

  /// What learns. A segment is given to `start`.
  ModelAverage& average() { return average_; }
  const ModelAverage& average() const { return average_; }
  const SurfaceSettings& settings() const { return average_.settings().surfaces; }

  /// Takes a segment, which `advance` learns piece by piece. The rest of the one before is learned now.
  void start(const InputHistory& inputs, const Segment& segment);
  /// One bounded piece. False when the segment is learned.
  bool advance();

  /// The estimate of a surface at its parting, without its last segments that were on another.
  const std::optional<SurfaceMemory>& parting() const { return parting_; }
  /// What was known before the segments from `since` [s] on.
  void mark_parting(double since);
  /// Start of the segments since a change of terrain [s], where one was found since the last call.
  std::optional<double> take_change() { return std::exchange(changed_since_, std::nullopt); }
  /// Forgets which segments were the last: another run begins, or another surface.
  void forget_recent() { recent_.clear(); }
  /// The last segments of the run.
  const std::deque<Recent>& recent() const { return recent_; }
  /// The place of the first of them from `since` [s] on.
  std::size_t recent_since(double since) const;
  /// Log odds that a trial would give one of two surfaces against the other, were it the one and driven as of late.
  double apart(const SurfaceMemory& a, const SurfaceMemory& b, const DisturbanceModel& law) const;
  /// What is known of a candidate before the segments from `since` [s] on; `known` are the memories of the surfaces.
  SurfacePosterior posterior_on(const SurfaceCandidate& candidate, std::span<const SurfaceMemory> known,
                                double since) const;
  /// Begins on a surface that is remembered, as if it had just been left after so many `seconds` of driving.
  void begin_on(const SurfaceMemory& surface, double seconds, double segment_length);

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const RememberingAverage& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.average_, self.recent_, self.probes_, self.parting_, self.changed_since_);
  }

 private:
  void note(const InputHistory& inputs, const Segment& segment);
  SurfacePosterior posterior_of(const AverageState& state) const;

  ModelAverage average_;
  std::deque<Recent> recent_;
  std::deque<Recent> probes_;  ///< some of those before, by which surfaces are compared
  std::optional<SurfaceMemory> parting_;
  std::optional<double> changed_since_;  ///< [s], of a change that nobody took
};

}  // namespace slipwise
