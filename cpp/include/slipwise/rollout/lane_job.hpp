// SPDX-License-Identifier: Apache-2.0
// What the kernels are handed: plain pointers and numbers, so that nothing compiled for one processor reaches another.
#pragma once

#include <cstddef>
#include <cstdint>

#include "slipwise/lie/lane_function.hpp"
#include "slipwise/rollout/drive_command.hpp"
#include "slipwise/rollout/lane_car_job.hpp"
#include "slipwise/slip/path_edges.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

inline constexpr std::size_t kMostLanes = 64;  ///< rollouts of one block at any instruction level

/// A product of the slip program; its parent is an earlier one, its channels are bits.
struct LaneProduct {
  std::uint8_t parent;
  std::uint8_t factor;
  std::uint8_t channels;
};

/// Where the products of a quadratic program stand; kProductOne, which has no share, where there is none.
struct LaneQuadratic {
  std::size_t curvature, curvature_squared, speed_by_curvature, speed_squared;
};

/// What a channel does over a part, as sums of what acts at its start: the mean of the drive, and what the two lags
/// hold at its end.
template <typename Scalar>
struct LaneLag {
  Scalar mean_by_input, mean_by_fast, mean_by_slow;
  Scalar fast_by_input, fast_by_fast;
  Scalar slow_by_input, slow_by_slow;
};

/// A part of the control period (chain_schedule.hpp) in the kernel's numbers.
template <typename Scalar>
struct LanePart {
  std::size_t first_coefficient;  ///< its coefficients stand from here on in the job's
  Scalar duration;
  LaneLag<Scalar> v, omega;
  bool next_v, next_omega;
};

/// Limits of one lane of the drive (command_limits.hpp) in the kernel's numbers. What is not limited has no dead-band,
/// and the largest saturation and rates.
template <typename Scalar>
struct RampLimits {
  Scalar dead_band, saturation;
  Scalar slew_rate_up, slew_rate_down;  ///< over a piece of the period
  Scalar per_slew_up, per_slew_down;    ///< one over these; zero where they are not limited
  Scalar closes, per_closes;            ///< of a gap, what the lag of the rates closes over a piece; one over that
  bool ramps;                           ///< some rate is limited
  bool lags;                            ///< the rates are behind a lag
};

/// Limits of the commands, and of the two sides behind them.
template <typename Scalar>
struct DriveRamps {
  RampLimits<Scalar> speed, yaw_rate, side;
  Scalar gain_v, half_separation;  ///< from a command to its sides; with the gain of the yaw rate
  Scalar per_separation;
  bool sides;  ///< some limit of the sides
};

/// A costmap in the kernel's numbers; null cells where none is sampled.
template <typename Scalar>
struct LaneMap {
  const float* cells;
  std::size_t columns;
  Scalar width, height;  ///< in cells
  Scalar per_metre;      ///< cells per metre
  float outside;
};

template <typename Scalar>
struct LaneTangents;
template <typename Scalar>
struct LaneFutures;

template <typename Scalar>
struct LaneJob {
  const LanePart<Scalar>* parts;  ///< those of the lead-in, the cycle and the tail (chain_schedule.hpp)
  const Scalar* coefficients;     ///< [parts][products * 3], times the part's duration: from products to a tangent
  std::size_t cycle, branch, tail, part_end;  ///< where these begin in the parts
  const LaneProduct* products;
  std::size_t product_count;
  bool is_quadratic;  ///< of second degree in speed and curvature, as the thesis's basis is
  LaneQuadratic quadratic;
  unsigned factors;  ///< bits of the slip factors in use
  Scalar squared_curvature_speed;
  bool on_grade;             ///< the ground is a plane that is not level
  Scalar rise_x, rise_y;     ///< of it per metre along the axes of the starts' frame
  Scalar minus_gravity;      ///< [m/s^2]
  std::size_t edge_count;    ///< where slip becomes another along the path; after a part's coefficients stand
  Scalar edges[kMostEdges];  ///< what they change by at each of these distances [m]
  Scalar sharpest;           ///< curvature of a drive that steers, whose channel `omega` is [1/m]; 0: it does not steer
  std::ptrdiff_t shift_v, shift_omega;
  bool lags;
  bool responds;  ///< some channel has a gain or a slow mode

  const DriveRamps<Scalar>* limits;  ///< null where the commands pass as they are
  /// Limited commands are cut into so many pieces each and stand side by side, those before the start first; what
  /// follows counts pieces then. Without limits a command is one piece.
  std::size_t pieces;
  std::ptrdiff_t start_row;  ///< of the first command or piece from the start on
  std::ptrdiff_t last_row;   ///< what it holds goes on

  std::size_t rollouts, periods;
  const Scalar* v;
  const Scalar* omega;
  const Scalar* vy;  ///< null where the robot does not drive sideways
  std::ptrdiff_t rollout_stride, period_stride;

  Scalar* path[3];  ///< x, y, theta: null or [periods * rollouts]
  Scalar* end[3];   ///< null or [rollouts]
  LaneMap<Scalar> map;
  Scalar* cost_sum;
  Scalar* cost_highest;
  Scalar* cost_lowest;

  const LaneTangents<Scalar>* tangents;  ///< of a kernel of tangents (lane_tangent_job.hpp)
  const LaneFutures<Scalar>* futures;    ///< of a kernel of futures (lane_noise_job.hpp)
};

/// One channel of the drives at the start (actuator_start.hpp), a number per lane.
template <typename Scalar>
struct LaneStart {
  Scalar* commanded;
  Scalar* fast;
  Scalar* slow;
};

/// Some neighbouring rollouts and where they start, one a lane.
template <typename Scalar>
struct LaneBlock {
  Scalar* x;
  Scalar* y;
  Scalar* theta;
  Scalar* cosine;
  Scalar* sine;
  LaneStart<Scalar> v;
  LaneStart<Scalar> omega;
  LaneStart<Scalar> vy;
  Scalar* cell_x;  ///< the start in cells of the map
  Scalar* cell_y;
  const DriveCommand* past;  ///< the commands sent before the start, the oldest first
  std::size_t past_count;    ///< of one start
  std::size_t past_stride;   ///< from one rollout's to the next one's
  std::size_t first;
  std::size_t count;
  bool side_by_side;  ///< a period's commands can be read as they lie
};

/// Rollouts of the block. A single lane always has one, which its compiler must know.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES std::size_t lanes_in(const LaneBlock<Scalar>& block) {
  return L::kLanes == 1 ? 1 : block.count;
}

inline constexpr std::size_t kStartRows = 16;  ///< numbers per lane that a block points to

/// Lets a block point to kStartRows rows of numbers, one after the other.
template <typename Scalar>
SLIPWISE_LANES void point_to_rows(Scalar* rows, std::size_t length, LaneBlock<Scalar>& block) {
  block.x = rows;
  block.y = rows + length;
  block.theta = rows + 2 * length;
  block.cosine = rows + 3 * length;
  block.sine = rows + 4 * length;
  block.v = {rows + 5 * length, rows + 6 * length, rows + 7 * length};
  block.omega = {rows + 8 * length, rows + 9 * length, rows + 10 * length};
  block.vy = {rows + 11 * length, rows + 12 * length, rows + 13 * length};
  block.cell_x = rows + 14 * length;
  block.cell_y = rows + 15 * length;
}

/// What the ramps of a block's drives hold at the start.
template <typename Scalar>
struct RampStart {
  alignas(64) Scalar speed[kMostLanes];
  alignas(64) Scalar yaw_rate[kMostLanes];
  alignas(64) Scalar left[kMostLanes];
  alignas(64) Scalar right[kMostLanes];
};

/// Where a block's limited commands go: rows of pieces, as wide as the kernel's lanes.
template <typename Scalar>
struct LimitedRows {
  Scalar* v;
  Scalar* omega;
  Scalar* vy;           ///< null where the robot does not drive sideways
  std::size_t periods;  ///< from the start on, of `pieces` rows each
};

/// What went wrong in a block, as bits.
inline constexpr unsigned kNoFault = 0, kNotFinite = 1, kTurnsTooFar = 2;

/// Rolls one block out; one function per instruction level.
template <typename Scalar>
using LaneKernel = unsigned (*)(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block);

/// Puts the commands of one block behind the limits; `job` has them as they are given.
template <typename Scalar>
using LaneLimiter = void (*)(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block, const RampStart<Scalar>& start,
                             const LimitedRows<Scalar>& rows);

template <typename Scalar>
struct LaneKernelOfLevel {
  LaneKernel<Scalar> roll;
  LaneLimiter<Scalar> limit;
  LaneCar<Scalar> drive_cars;
  std::size_t lanes;  ///< rollouts per block
};

/// Each is defined where it is compiled for its processors; null where the build has none of them.
LaneKernelOfLevel<float> portable_kernel(float);
LaneKernelOfLevel<double> portable_kernel(double);
LaneKernelOfLevel<float> avx2_kernel(float);
LaneKernelOfLevel<double> avx2_kernel(double);
LaneKernelOfLevel<float> avx512_kernel(float);
LaneKernelOfLevel<double> avx512_kernel(double);

/// Kernels whose blocks are rolled out with tangents, or with drawn noise; they drive no cars.
template <typename Scalar>
struct UncertainKernels {
  LaneKernelOfLevel<Scalar> tangents, futures;
};
UncertainKernels<float> portable_uncertain(float);
UncertainKernels<double> portable_uncertain(double);
UncertainKernels<float> avx2_uncertain(float);
UncertainKernels<double> avx2_uncertain(double);
UncertainKernels<float> avx512_uncertain(float);
UncertainKernels<double> avx512_uncertain(double);

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
