// SPDX-License-Identifier: Apache-2.0
// Rollouts of the model, whose poses become the velocities that lead from one to the next.
#include "slipwise/planning/predict_columns.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/lie/lane_arc.hpp"
#include "slipwise/rollout/lanes.hpp"
#include "slipwise/rollout/rollout_threads.hpp"

namespace slipwise::planning {
namespace {

using Vector = NativeVector<float, 16>::Type;
constexpr std::size_t kLanes = sizeof(Vector) / sizeof(float);
constexpr std::size_t kChunk = 128;  ///< rollouts whose poses stay in the processor's nearer caches; whole vectors

Vector read(const float* from) {
  Vector vector;
  load(from, vector);
  return vector;
}

/// Where some rollouts were at the end of the period before.
struct LastPoses {
  alignas(64) std::array<float, kChunk> x{}, y{}, theta{}, cosine{}, sine{};
};

/// The poses of a chunk: rows of kChunk numbers, of which the first `count` are rollouts.
struct ChunkPoses {
  explicit ChunkPoses(std::size_t periods) : x(kChunk * periods), y(kChunk * periods), theta(kChunk * periods) {}
  std::vector<float> x, y, theta;
};

/// Turns the poses of a vector of rollouts after one period, which stand at `at`, into velocities in their place.
template <bool kWide>
SLIPWISE_LANES void convert(ChunkPoses& poses, std::size_t at, std::size_t lane, float per_period, LastPoses& last) {
  const Vector x = read(&poses.x[at]);
  const Vector y = read(&poses.y[at]);
  const Vector theta = read(&poses.theta[at]);
  const Vector dx = x - read(&last.x[lane]);
  const Vector dy = y - read(&last.y[lane]);
  const Vector turn = theta - read(&last.theta[lane]);
  const Vector cosine = read(&last.cosine[lane]);
  const Vector sine = read(&last.sine[lane]);
  store((dx * cosine + dy * sine) * per_period, &poses.x[at]);
  store((dy * cosine - dx * sine) * per_period, &poses.y[at]);
  store(turn * per_period, &poses.theta[at]);
  LaneArc<Vector> arc;
  if constexpr (kWide) {
    wide_lane_arc<float>(turn, arc);
  } else {
    lane_arc<float>(turn, arc);
  }
  store(cosine - turn * (arc.a * sine + arc.b * cosine), &last.cosine[lane]);
  store(sine + turn * (arc.a * cosine - arc.b * sine), &last.sine[lane]);
  store(x, &last.x[lane]);
  store(y, &last.y[lane]);
  store(theta, &last.theta[lane]);
}

/// Whether some rollout turns within a period by more than the plain series takes.
bool turns_wide(const ChunkPoses& poses) {
  const std::size_t rows = poses.theta.size() / kChunk;
  auto widest = Vector{};
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t n = 0; n < kChunk; n += kLanes) {
      const Vector now = read(&poses.theta[k * kChunk + n]);
      const Vector turn = k == 0 ? now : now - read(&poses.theta[(k - 1) * kChunk + n]);
      const Vector squared = turn * turn;
      widest = squared > widest ? squared : widest;
    }
  }
  std::array<float, kLanes> each{};
  store(widest, each.data());
  return std::ranges::max(each) > static_cast<float>(kLaneTurn * kLaneTurn);
}

template <bool kWide>
void convert_chunk(ChunkPoses& poses, float per_period) {
  LastPoses last;
  last.cosine.fill(1.0F);
  for (std::size_t row = 0; row < poses.theta.size(); row += kChunk) {
    for (std::size_t n = 0; n < kChunk; n += kLanes) {
      convert<kWide>(poses, row + n, n, per_period, last);
    }
  }
}

/// The commands of fewer rollouts than a chunk, and the first one's in place of those that are missing.
CommandView<float> padded(const CommandView<float>& view, std::size_t count, std::size_t periods,
                          std::array<std::vector<float>, 3>& columns) {
  const auto pad = [&](const float* given, std::vector<float>& column) -> const float* {
    if (given == nullptr) {
      return nullptr;
    }
    column.resize(kChunk * periods);
    for (std::size_t k = 0; k < periods; ++k) {
      const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(k) * view.period_stride;
      for (std::size_t n = 0; n < kChunk; ++n) {
        column[k * kChunk + n] = given[row + (n < count ? static_cast<std::ptrdiff_t>(n) : 0)];
      }
    }
    return column.data();
  };
  return {.v = pad(view.v, columns[0]),
          .omega = pad(view.omega, columns[1]),
          .rollout_stride = 1,
          .period_stride = kChunk,
          .vy = pad(view.vy, columns[2])};
}

/// Rolls a chunk out, and writes its velocities.
struct ColumnWork {
  const RolloutProgram& program;
  const CommandColumns& commands;
  const RolloutStart& start;
  std::span<const DriveCommand> in_flight;
  const VelocityColumns& velocities;
  RolloutOptions options;
  ChunkPoses poses = ChunkPoses(commands.periods);
  std::array<std::vector<float>, 3> padded_columns = {};

  void at(std::size_t first) {
    const std::size_t count = std::min(kChunk, commands.rollouts - first);
    CommandView<float> view{.v = commands.v + first,
                            .omega = commands.omega + first,
                            .rollout_stride = 1,
                            .period_stride = static_cast<std::ptrdiff_t>(commands.rollouts),
                            .vy = commands.vy == nullptr ? nullptr : commands.vy + first};
    if (count < kChunk) {
      view = padded(view, count, commands.periods, padded_columns);
    }
    RolloutOutputs<float> outputs;
    outputs.x = poses.x.data();
    outputs.y = poses.y.data();
    outputs.theta = poses.theta.data();
    try {
      rollout_batch<float>(program, {kChunk, commands.periods, view, {&start, 1}, in_flight}, outputs, options);
    } catch (const std::invalid_argument& problem) {
      throw std::invalid_argument("counted from rollout " + std::to_string(first) + ": " + problem.what());
    }
    const auto per_period = static_cast<float>(1.0 / program.setting().period);
    (turns_wide(poses) ? convert_chunk<true> : convert_chunk<false>)(poses, per_period);
    for (std::size_t k = 0; k < commands.periods; ++k) {
      const std::size_t to = k * commands.rollouts + first;
      std::copy_n(&poses.x[k * kChunk], count, velocities.vx + to);
      std::copy_n(&poses.y[k * kChunk], count, velocities.vy + to);
      std::copy_n(&poses.theta[k * kChunk], count, velocities.wz + to);
    }
  }
};

}  // namespace

void predict_columns(const RolloutProgram& program, const CommandColumns& commands, const ColumnStart& start,
                     const VelocityColumns& velocities, const RolloutOptions& options) {
  if (velocities.vx == nullptr || velocities.vy == nullptr || velocities.wz == nullptr) {
    throw std::invalid_argument("there is no place for the velocities; point to three columns");
  }
  if (commands.rollouts == 0 || commands.periods == 0 || commands.v == nullptr || commands.omega == nullptr) {
    throw std::invalid_argument("there are no commands; point to at least one sequence of one period");
  }
  const RolloutStart at_origin{.pose = {}, .drive = start.drive};
  RolloutOptions on_one_thread = options;
  on_one_thread.threads = 1;
  share_out((commands.rollouts + kChunk - 1) / kChunk, options.threads, [&](std::size_t first, std::size_t last) {
    ColumnWork work{program, commands, at_origin, start.in_flight, velocities, on_one_thread};
    for (std::size_t chunk = first; chunk < last; ++chunk) {
      work.at(chunk * kChunk);
    }
  });
}

}  // namespace slipwise::planning
