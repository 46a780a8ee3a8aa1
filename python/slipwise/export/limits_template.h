/* Limits of one lane, the same for both signs. */
typedef struct {
  slipwise_real dead_band, top, acceleration, braking, lag; /* with a lag, rates are of what it makes of the commands */
} slipwise_lane;

#define SLIPWISE_LANE_OF(a, b, c, d, e) {SLIPWISE_R(a), SLIPWISE_R(b), SLIPWISE_R(c), SLIPWISE_R(d), SLIPWISE_R(e)}
#define SLIPWISE_LANE(limits) SLIPWISE_LANE_OF(limits)
static const slipwise_lane slipwise_lanes[3] = {
    SLIPWISE_LANE(SLIPWISE_LIMITS_SPEED),
    SLIPWISE_LANE(SLIPWISE_LIMITS_YAW_RATE),
    SLIPWISE_LANE(SLIPWISE_LIMITS_SIDE)};
#define SLIPWISE_RAMP_PIECE SLIPWISE_R(@PIECE@) /* [s] a ramp becomes held pieces of its mean, no longer than this */
#define SLIPWISE_RAMP_PIECES 2000               /* of one ramp at most, however slow */
#define SLIPWISE_LONGEST_RAMP SLIPWISE_R(1e6)   /* [s] */
#define SLIPWISE_NO_TIME SLIPWISE_R(1e-6)       /* [s] commands less apart come together */

/* The set speed of a lane, which follows its target as fast as it may. */
typedef struct {
  slipwise_real state, target;
} slipwise_ramp;

static inline slipwise_real slipwise_limited(const slipwise_lane *lane, slipwise_real command) {
  const slipwise_real passed = SLIPWISE_MATH(fabs)(command) < lane->dead_band ? SLIPWISE_R(0) : command;
  return passed > lane->top ? lane->top : passed < -lane->top ? -lane->top : passed;
}

static inline slipwise_real slipwise_ramp_rate(const slipwise_lane *lane, slipwise_real from, slipwise_real to) {
  return SLIPWISE_MATH(fabs)(to) < SLIPWISE_MATH(fabs)(from) ? lane->braking : lane->acceleration;
}

static inline slipwise_real slipwise_ramp_seconds(const slipwise_lane *lane, slipwise_real from, slipwise_real to) {
  const int turns = from * to < 0;
  if (lane->lag > 0) { /* it ramps where the lag alone would be too quick */
    const slipwise_real least = lane->braking < lane->acceleration ? lane->braking : lane->acceleration;
    const slipwise_real rate = turns ? least : slipwise_ramp_rate(lane, from, to);
    if (SLIPWISE_MATH(fabs)(to - from) <= rate * lane->lag) {
      return 0;
    }
  }
  if (turns) { /* through zero: braking first */
    return SLIPWISE_MATH(fabs)(from) / lane->braking + SLIPWISE_MATH(fabs)(to) / lane->acceleration +
           lane->lag * SLIPWISE_MATH(log1p)(SLIPWISE_MATH(fabs)(from / to));
  }
  return SLIPWISE_MATH(fabs)(to - from) / slipwise_ramp_rate(lane, from, to);
}

/* On its way to `target` it has come as far as `state`, if it was not yet so far. */
static inline void slipwise_ramp_reach(slipwise_ramp *ramp, slipwise_real state, slipwise_real target) {
  const slipwise_real done = state - ramp->state, whole = target - ramp->state;
  if (done * whole > 0) {
    ramp->state = SLIPWISE_MATH(fabs)(done) < SLIPWISE_MATH(fabs)(whole) ? state : target;
  }
}

/* Follows the target for some seconds; returns the integral. */
static inline slipwise_real slipwise_ramp_follow(const slipwise_lane *lane, slipwise_ramp *ramp,
                                                 slipwise_real seconds) {
  slipwise_real integral = 0;
  int phase;
  for (phase = 0; phase < 2 && (ramp->state < ramp->target || ramp->state > ramp->target); ++phase) {
    const slipwise_real goal = ramp->state * ramp->target < 0 ? SLIPWISE_R(0) : ramp->target;
    const slipwise_real rate = slipwise_ramp_rate(lane, ramp->state, goal);
    const slipwise_real needed = SLIPWISE_MATH(fabs)(goal - ramp->state) / rate;
    const slipwise_real taken = needed < seconds ? needed : seconds;
    const slipwise_real before = ramp->state;
    if (needed <= seconds) {
      ramp->state = goal;
    } else {
      ramp->state += goal > before ? rate * seconds : -rate * seconds;
    }
    integral += (before + ramp->state) / 2 * taken;
    seconds -= taken;
  }
  return integral + ramp->state * seconds;
}

/* What of the target a lag may be given for a piece, so that it changes no quicker than the rates. */
static inline slipwise_real slipwise_kept_near(const slipwise_lane *lane, const slipwise_ramp *ramp,
                                               slipwise_real piece) {
  const slipwise_real closes = -SLIPWISE_MATH(expm1)(-piece / lane->lag);
  const slipwise_real size = SLIPWISE_MATH(fabs)(ramp->state);
  const slipwise_real wanted = SLIPWISE_MATH(fabs)(ramp->target - ramp->state) * closes;
  const int turns = ramp->state * ramp->target < 0;
  const slipwise_real most =
      piece * (turns ? lane->braking : slipwise_ramp_rate(lane, ramp->state, ramp->target));
  slipwise_real moved = wanted < most ? wanted : most;
  if (turns && moved > size) { /* and from zero on for the rest of the piece */
    const slipwise_real rest = size + lane->acceleration * piece * (1 - size / moved);
    moved = moved < rest ? moved : rest;
  }
  if (moved >= wanted) {
    return ramp->target;
  }
  return ramp->state + (ramp->target > ramp->state ? moved : -moved) / closes;
}

/* The mean over a piece, of which `taken` seconds pass. */
static inline slipwise_real slipwise_ramp_mean(const slipwise_lane *lane, slipwise_ramp *ramp, slipwise_real command,
                                               slipwise_real piece, slipwise_real taken) {
  slipwise_ramp whole;
  ramp->target = slipwise_limited(lane, command);
  if (lane->lag > 0) {
    const slipwise_real kept = slipwise_kept_near(lane, ramp, piece);
    ramp->state += (ramp->state - kept) * SLIPWISE_MATH(expm1)(-taken / lane->lag);
    return kept;
  }
  whole = *ramp;
  slipwise_ramp_follow(lane, ramp, taken);
  return slipwise_ramp_follow(lane, &whole, piece) / piece;
}

/* What a twist asks of both sides, and back. */
static inline void slipwise_to_sides(slipwise_drive twist, slipwise_real sides[2]) {
  const slipwise_real v = SLIPWISE_LIMITS_GAIN_V * twist.v;
  const slipwise_real half = SLIPWISE_LIMITS_GAIN_OMEGA * twist.omega * SLIPWISE_LIMITS_WHEEL_SEPARATION / 2;
  sides[0] = v - half;
  sides[1] = v + half;
}

static inline slipwise_drive slipwise_from_sides(const slipwise_real sides[2]) {
  slipwise_drive twist;
  twist.v = (sides[0] + sides[1]) / 2;
  twist.omega = (sides[1] - sides[0]) / SLIPWISE_LIMITS_WHEEL_SEPARATION;
@SIDE{  twist.vy = 0;
}@  return twist;
}

/* The commands of one channel as the drive sees them: limited, piece by piece, and delayed. */
typedef struct {
  const slipwise_commands *commands;
  slipwise_start at;
  int v_reached, omega_reached; /* whether the ramps have been moved to where the measured drive is */
  slipwise_real delay, known_until;
  slipwise_ramp speed, yaw_rate, side[2];
  slipwise_drive commanded, held;
  slipwise_real change, piece; /* when the next piece begins, as commands are stamped [s]; how long pieces are [s] */
  int next;                    /* the command that is commanded next */
  int pieces;                  /* of the last one, so far */
} slipwise_cursor;

static inline slipwise_real slipwise_told_next(const slipwise_cursor *cursor) {
  return cursor->next < cursor->commands->count ? slipwise_command_at(cursor->commands, cursor->next)->t
                                                : SLIPWISE_R(INFINITY);
}

/* The part of the command that remains once all ramps are over. */
static inline slipwise_drive slipwise_goal(const slipwise_cursor *cursor) {
  slipwise_drive goal = {0,@SIDE{ 0,}@ 0};
  goal.v = slipwise_limited(&slipwise_lanes[0], cursor->commanded.v);
  goal.omega = slipwise_limited(&slipwise_lanes[1], cursor->commanded.omega);
#if SLIPWISE_LIMITS_SIDES
  {
    slipwise_real sides[2];
    slipwise_to_sides(goal, sides);
    sides[0] = slipwise_limited(&slipwise_lanes[2], sides[0]);
    sides[1] = slipwise_limited(&slipwise_lanes[2], sides[1]);
    goal = slipwise_from_sides(sides);
  }
#endif
@SIDE{  goal.vy = cursor->commanded.vy; /* passes as it is */
}@  return goal;
}

/* No ramp takes longer [s]; 0 where all are over. */
static inline slipwise_real slipwise_seconds_left(const slipwise_cursor *cursor) {
  slipwise_drive goal = {0,@SIDE{ 0,}@ 0};
  slipwise_real left, other;
  goal.v = slipwise_limited(&slipwise_lanes[0], cursor->commanded.v);
  goal.omega = slipwise_limited(&slipwise_lanes[1], cursor->commanded.omega);
  left = slipwise_ramp_seconds(&slipwise_lanes[0], cursor->speed.state, goal.v);
  other = slipwise_ramp_seconds(&slipwise_lanes[1], cursor->yaw_rate.state, goal.omega);
  left = other > left ? other : left;
#if SLIPWISE_LIMITS_SIDES
  {
    const slipwise_lane *const lane = &slipwise_lanes[2];
    slipwise_real sides[2], longest;
    slipwise_to_sides(goal, sides);
    longest = slipwise_ramp_seconds(lane, cursor->side[0].state, slipwise_limited(lane, sides[0]));
    other = slipwise_ramp_seconds(lane, cursor->side[1].state, slipwise_limited(lane, sides[1]));
    left += other > longest ? other : longest;
  }
#endif
  return left;
}

/* What the commands of a measured drive are, in front of the sides' limits. */
static inline slipwise_drive slipwise_asked(const slipwise_cursor *cursor) {
  slipwise_drive asked = cursor->at.keeping;
#if SLIPWISE_LIMITS_SIDES
  asked.v /= SLIPWISE_LIMITS_GAIN_V;
  asked.omega /= SLIPWISE_LIMITS_GAIN_OMEGA;
#endif
  return asked;
}

/* Before the piece that ends at `end`: the drive was measured, and ramps have come at least as far as that. */
static inline void slipwise_reach(slipwise_cursor *cursor, slipwise_real end) {
  const slipwise_drive asked = slipwise_asked(cursor);
  const int v = !cursor->v_reached && end > cursor->at.v_until;
  const int omega = !cursor->omega_reached && end > cursor->at.omega_until;
  slipwise_drive goal = {0,@SIDE{ 0,}@ 0};
  goal.v = slipwise_limited(&slipwise_lanes[0], cursor->commanded.v);
  goal.omega = slipwise_limited(&slipwise_lanes[1], cursor->commanded.omega);
  if (v) {
    slipwise_ramp_reach(&cursor->speed, asked.v, goal.v);
    cursor->v_reached = 1;
  }
  if (omega) {
    slipwise_ramp_reach(&cursor->yaw_rate, asked.omega, goal.omega);
    cursor->omega_reached = 1;
  }
#if SLIPWISE_LIMITS_SIDES
  if (v || omega) {
    slipwise_real sides[2], goals[2];
    int i;
    slipwise_to_sides(asked, sides);
    slipwise_to_sides(goal, goals);
    for (i = 0; i < 2; ++i) {
      slipwise_ramp_reach(&cursor->side[i], sides[i], slipwise_limited(&slipwise_lanes[2], goals[i]));
    }
  }
#endif
}

static inline slipwise_drive slipwise_piece_mean(slipwise_cursor *cursor, slipwise_real taken) {
  slipwise_drive mean = {0,@SIDE{ 0,}@ 0};
  mean.v = slipwise_ramp_mean(&slipwise_lanes[0], &cursor->speed, cursor->commanded.v, cursor->piece, taken);
  mean.omega = slipwise_ramp_mean(&slipwise_lanes[1], &cursor->yaw_rate, cursor->commanded.omega, cursor->piece, taken);
#if SLIPWISE_LIMITS_SIDES
  {
    slipwise_real sides[2];
    int i;
    slipwise_to_sides(mean, sides);
    for (i = 0; i < 2; ++i) {
      sides[i] = slipwise_ramp_mean(&slipwise_lanes[2], &cursor->side[i], sides[i], cursor->piece, taken);
    }
    mean = slipwise_from_sides(sides);
  }
#endif
@SIDE{  mean.vy = cursor->commanded.vy;
}@  return mean;
}

/* The next command is commanded. Pieces divide the time that the one before was held. */
static inline void slipwise_tell(slipwise_cursor *cursor) {
  const slipwise_command *const command = slipwise_command_at(cursor->commands, cursor->next);
  slipwise_real hold = SLIPWISE_RAMP_PIECE, parts, ramp;
  if (cursor->next > 0) {
    hold = command->t - slipwise_command_at(cursor->commands, cursor->next - 1)->t;
  }
  cursor->change = command->t;
  cursor->commanded.v = command->v;
@SIDE{  cursor->commanded.vy = command->vy;
}@  cursor->commanded.omega = command->omega;
  ++cursor->next;
  parts = SLIPWISE_MATH(ceil)(hold / SLIPWISE_RAMP_PIECE - SLIPWISE_SAME_STEP);
  cursor->piece = hold / (parts < 1 ? SLIPWISE_R(1) : parts);
  ramp = slipwise_seconds_left(cursor);
  ramp = (ramp < SLIPWISE_LONGEST_RAMP ? ramp : SLIPWISE_LONGEST_RAMP) / SLIPWISE_RAMP_PIECES;
  cursor->piece = ramp > cursor->piece ? ramp : cursor->piece;
  cursor->pieces = 0;
}

/* The piece that begins at `change` is held from now on. */
static inline void slipwise_next_piece(slipwise_cursor *cursor) {
  slipwise_real left;
  while (slipwise_told_next(cursor) - cursor->change <= SLIPWISE_NO_TIME) {
    slipwise_tell(cursor);
  }
  left = slipwise_told_next(cursor) - cursor->change;
  if (slipwise_seconds_left(cursor) > 0 && cursor->pieces <= SLIPWISE_RAMP_PIECES) {
    const slipwise_real taken = cursor->piece < left ? cursor->piece : left;
    slipwise_reach(cursor, cursor->change + taken);
    if (slipwise_seconds_left(cursor) > 0) {
      cursor->held = slipwise_piece_mean(cursor, taken);
      cursor->change += taken;
      ++cursor->pieces;
      return;
    }
  }
  cursor->held = slipwise_goal(cursor);
  if (left < SLIPWISE_R(INFINITY)) { /* what lags goes on */
    cursor->piece = left;
    slipwise_piece_mean(cursor, left);
  }
  cursor->change = slipwise_told_next(cursor);
}

static inline slipwise_drive slipwise_held(const slipwise_cursor *cursor) { return cursor->held; }

/* When the channel changes next, or `never`. */
static inline slipwise_real slipwise_change(const slipwise_cursor *cursor, slipwise_real never) {
  return cursor->change <= cursor->known_until ? cursor->change + cursor->delay : never;
}

/* Passes the changes until `t`. */
static inline void slipwise_catch_up(slipwise_cursor *cursor, slipwise_real t) {
  while (cursor->change <= cursor->known_until && cursor->change + cursor->delay <= t) {
    slipwise_next_piece(cursor);
  }
}

/* Whether some command acts already. */
static inline int slipwise_acts(const slipwise_cursor *cursor) { return cursor->next > 0; }

/* Before the oldest command, sent at `first`: at rest, or where it does not act by the time at which the drive was
 * measured, what keeps that. */
static inline void slipwise_begin(slipwise_cursor *cursor, slipwise_real first) {
  const slipwise_drive asked = slipwise_asked(cursor);
  slipwise_drive before = {0,@SIDE{ 0,}@ 0};
  slipwise_real sides[2];
  cursor->v_reached = !cursor->at.measured || first > cursor->at.v_until;
  cursor->omega_reached = !cursor->at.measured || first > cursor->at.omega_until;
  if (cursor->at.measured && cursor->v_reached) {
    before.v = asked.v;
@SIDE{    before.vy = asked.vy;
}@  }
  if (cursor->at.measured && cursor->omega_reached) {
    before.omega = asked.omega;
  }
  slipwise_to_sides(before, sides);
  cursor->speed.state = cursor->speed.target = before.v;
  cursor->yaw_rate.state = cursor->yaw_rate.target = before.omega;
  cursor->side[0].state = cursor->side[0].target = sides[0];
  cursor->side[1].state = cursor->side[1].target = sides[1];
  cursor->commanded = cursor->held = before;
}

static inline slipwise_cursor slipwise_cursor_at(const slipwise_commands *commands, const slipwise_start *at,
                                                 slipwise_real delay, slipwise_real start, slipwise_real known_until) {
  slipwise_cursor cursor;
  cursor.commands = commands;
  cursor.delay = delay;
  cursor.known_until = known_until;
  cursor.at = *at;
  slipwise_begin(&cursor, slipwise_command_at(commands, 0)->t);
  cursor.piece = SLIPWISE_RAMP_PIECE;
  cursor.next = cursor.pieces = 0;
  cursor.change = slipwise_told_next(&cursor);
  slipwise_catch_up(&cursor, start);
  return cursor;
}
