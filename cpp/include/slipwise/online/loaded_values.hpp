// SPDX-License-Identifier: Apache-2.0
// What has to hold of the plain structs of a learner that is loaded, whatever the bytes are.
#pragma once

#include <type_traits>

#include "slipwise/online/held_out.hpp"
#include "slipwise/online/segment_stream.hpp"
#include "slipwise/online/source_merge.hpp"

namespace slipwise {

/// For an archive::CheckedReader. Each throws std::invalid_argument where the numbers of a struct cannot be: lists that
/// go together differ in length, an estimate is no normal distribution, times do not go forward.
struct LoadedValues {
  template <class T>
  using Type = std::type_identity<T>;

  static void check(Type<Estimate> type, const Estimate& value);
  static void check(Type<NormalEquations> type, const NormalEquations& value);
  static void check(Type<MotionPosterior> type, const MotionPosterior& value);
  static void check(Type<SurfaceSlip> type, const SurfaceSlip& value);
  static void check(Type<SurfaceMemory> type, const SurfaceMemory& value);
  static void check(Type<Segment> type, const Segment& value);
  static void check(Type<SegmentPath> type, const SegmentPath& value);
  static void check(Type<SegmentLinearization> type, const SegmentLinearization& value);
  static void check(Type<WheelSegment> type, const WheelSegment& value);
  static void check(Type<WheelMeans> type, const WheelMeans& value);
  static void check(Type<ChannelRun> type, const ChannelRun& value);
  static void check(Type<TwistStretch> type, const TwistStretch& value);
  static void check(Type<MeasuredPose> type, const MeasuredPose& value);
  static void check(Type<InputSample> type, const InputSample& value);
  static void check(Type<TimedNumber> type, const TimedNumber& value);
  static void check(Type<MeasuredTilts> type, const MeasuredTilts& value);
  static void check(Type<MappedGround> type, const MappedGround& value);
  static void check(Type<KnotCurve> type, const KnotCurve& value);
  static void check(Type<StreamSettings> type, const StreamSettings& value);
};

}  // namespace slipwise
