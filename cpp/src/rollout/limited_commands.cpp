// SPDX-License-Identifier: Apache-2.0
// What the limits gave before a rollout's start.
#include "slipwise/rollout/limited_commands.hpp"

namespace slipwise {

void add_pieces(const RolloutProgram& program, const DriveCommand& command, LimitedStart& start) {
  const double piece = program.actuator().period;
  start.limiter.tell({command.v, command.vy, command.omega});
  for (std::size_t i = 0; i < program.pieces(); ++i) {
    const BodyTwist mean = start.limiter.mean_over(piece, piece);
    start.given.push_back({mean.v, mean.omega, mean.vy});
  }
}

LimitedStart limited_start(const RolloutProgram& program, std::span<const DriveCommand> past,
                           const DriveCommand& commanded) {
  LimitedStart start{.limiter = CommandLimiter(program.setting().limits), .given = {}};
  if (past.empty()) {
    start.limiter.place({commanded.v, commanded.vy, commanded.omega});
    start.given.push_back(commanded);
    return start;
  }
  start.limiter.settle({past.front().v, past.front().vy, past.front().omega});
  const BodyTwist settled = start.limiter.target();
  start.given.push_back({settled.v, settled.omega, settled.vy});
  for (const DriveCommand& command : past) {
    add_pieces(program, command, start);
  }
  return start;
}

}  // namespace slipwise
