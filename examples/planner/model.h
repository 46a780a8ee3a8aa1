/*
 * slipwise 0.1.0, model model.yaml (sha256 8da4397d65bfc1bf), learned by slipwise 0.1.0
 * log: drive.mcap (sha256 b6525c9473f54fc9)
 * learned from 300 s of commands, basis full-linear-6
 * verdict: good. The learned model misses by 0.0649 m and 0.0169 rad after 5 s, where the plain model misses by 1.65 m and 0.733 rad (30 held-out windows).
 * known to hold for speeds -0.91 to 2 m/s and yaw rates -1 to 1 rad/s
 */
/* SPDX-License-Identifier: Apache-2.0
 *
 * The learned motion model, for microcontrollers and planners: C99 or C++, no memory of its own, nothing but <math.h>.
 *
 *   slipwise_command slots[64];
 *   slipwise_commands commands;
 *   slipwise_commands_init(&commands, slots, 64);
 *   slipwise_command_push(&commands, 0.0f, 1.0f, 0.3f);         // t [s], v [m/s], omega [rad/s]; held from t on
 *   slipwise_window window = {0.0f, 5.0f, 0, 0.0f, 0.0f};       // from 0 s to 5 s, drive follows from the commands
 *   slipwise_pose pose;
 *   if (slipwise_predict(&commands, &window, &pose, 0) == SLIPWISE_OK) { ... pose.x, pose.y, pose.yaw ... }
 *   slipwise_real covariance[3][3];                             // of x, y, yaw: m^2, m rad, rad^2
 *   slipwise_predict_covariance(&commands, &window, &pose, 0, covariance);
 *
 * x forward, y left, counter-clockwise; SI units. Numbers are float; define SLIPWISE_DOUBLE before including this for
 * double. In float keep times small: start them anew when the robot starts.
 */
#ifndef SLIPWISE_MODEL_H
#define SLIPWISE_MODEL_H

#include <math.h>

#ifdef SLIPWISE_DOUBLE
typedef double slipwise_real;
#define SLIPWISE_MATH(function) function
#define SLIPWISE_SMALL_TURN 0.03
#define SLIPWISE_SMALL_SPAN 0.01
#define SLIPWISE_DIFFERENCE 1e-3 /* of a standard deviation, for derivatives */
#else
typedef float slipwise_real;
#define SLIPWISE_MATH(function) function##f
#define SLIPWISE_SMALL_TURN 0.35f
#define SLIPWISE_SMALL_SPAN 0.2f
#define SLIPWISE_DIFFERENCE 0.25f
#endif
#define SLIPWISE_R(number) ((slipwise_real)(number))
#define SLIPWISE_SLOTS(count) ((count) > 0 ? (count) : 1) /* an array has one at least */

/* What was learned. Inputs are commanded speeds. */
#define SLIPWISE_DELAY_V SLIPWISE_R(0.17979255394262977)  /* [s] transport delay of the speed, 0.180 +- 0.017 */
#define SLIPWISE_GAIN_V SLIPWISE_R(1.0)  /* drive over input, of the speed */
#define SLIPWISE_LAG_V SLIPWISE_R(0.8279071739031711)  /* [s] time constant of the speed, 0.828 +- 0.018 */
#define SLIPWISE_SLOW_SHARE_V SLIPWISE_R(0.0)  /* share of the speed that follows slowly */
#define SLIPWISE_SLOW_LAG_V SLIPWISE_R(0.0)  /* [s] its time constant; 0 where there is none */
#define SLIPWISE_DELAY_OMEGA SLIPWISE_R(0.155888376852673)  /* [s] transport delay of the yaw rate, 0.16 +- 0.03 */
#define SLIPWISE_GAIN_OMEGA SLIPWISE_R(1.0)  /* drive over input, of the yaw rate */
#define SLIPWISE_LAG_OMEGA SLIPWISE_R(0.8526373815534295)  /* [s] time constant of the yaw rate, 0.85 +- 0.05 */
#define SLIPWISE_SLOW_SHARE_OMEGA SLIPWISE_R(0.0)  /* share of the yaw rate that follows slowly */
#define SLIPWISE_SLOW_LAG_OMEGA SLIPWISE_R(0.0)  /* [s] its time constant; 0 where there is none */
#define SLIPWISE_CLOCK_OFFSET SLIPWISE_R(0.0)  /* [s] poses are stamped this much later than the inputs */
#define SLIPWISE_P0 SLIPWISE_R(-0.013530321551158315)  /* lon.V [m/s per V], -0.014 +- 0.003 */
#define SLIPWISE_P1 SLIPWISE_R(-0.003941739370395638)  /* lon.w [m/s per w], -0.004 +- 0.005 */
#define SLIPWISE_P2 SLIPWISE_R(0.0002318653830289367)  /* lat.V [m/s per V], 0.000 +- 0.003 */
#define SLIPWISE_P3 SLIPWISE_R(-0.01587659421056705)  /* lat.w [m/s per w], -0.016 +- 0.005 */
#define SLIPWISE_P4 SLIPWISE_R(-0.00010030030672093808)  /* ang.V [rad/s per V], -0.0001 +- 0.0011 */
#define SLIPWISE_P5 SLIPWISE_R(-0.3829469452501794)  /* ang.w [rad/s per w], -0.383 +- 0.004 */
/* The range that the log held; beyond it the model is a guess. */
#define SLIPWISE_SPEED_MIN SLIPWISE_R(-0.9097974048555124)  /* [m/s] */
#define SLIPWISE_SPEED_MAX SLIPWISE_R(2.0)  /* [m/s] */
#define SLIPWISE_YAW_RATE_MIN SLIPWISE_R(-1.0)  /* [rad/s] */
#define SLIPWISE_YAW_RATE_MAX SLIPWISE_R(1.0)  /* [rad/s] */
/* The same model for the C++ library: terms of the slip basis, parts of the chain, and the parameter vector. */
#define SLIPWISE_TERMS_LON "V", "w"
#define SLIPWISE_TERMS_LAT "V", "w"
#define SLIPWISE_TERMS_ANG "V", "w"
#define SLIPWISE_PARAMETERS -0.013530321551158315, -0.003941739370395638, 0.0002318653830289367, -0.01587659421056705, -0.00010030030672093808, -0.3829469452501794, -0.18885423969413528, -0.1594209314256324, -1.7159515708019935, -1.8586150608442
#define SLIPWISE_SLIP_PARAMETERS 6
#define SLIPWISE_PARAMETER_COUNT 10
#define SLIPWISE_HAS_DYNAMICS 1
#define SLIPWISE_HAS_RESPONSE 0
#define SLIPWISE_HAS_CLOCK_OFFSET 0
/* Limits of the drive, in front of delay and lag: dead-band, top, acceleration, braking. */
#define SLIPWISE_LIMITS_SPEED 0.0, INFINITY, INFINITY, INFINITY
#define SLIPWISE_LIMITS_YAW_RATE 0.0, INFINITY, INFINITY, INFINITY
#define SLIPWISE_LIMITS_SIDE 0.0, INFINITY, INFINITY, INFINITY
#define SLIPWISE_LIMITS_TRACK SLIPWISE_R(1.0)  /* [m] between the sides */
#define SLIPWISE_LIMITS_GAIN_V SLIPWISE_R(1.0)  /* of what the sides are asked */
#define SLIPWISE_LIMITS_GAIN_OMEGA SLIPWISE_R(1.0)
#define SLIPWISE_LIMITS_SIDES 0
#define SLIPWISE_LONGEST_STEP SLIPWISE_R(0.1)  /* [s] a lagging drive is averaged over no more than this */
#define SLIPWISE_SAME_STEP SLIPWISE_R(1e-6)    /* of a step: a stretch longer by rounding gets no other step */
#define SLIPWISE_LONGEST_WINDOW SLIPWISE_R(1e5) /* [s] */
#define SLIPWISE_SETTLED_LAGS SLIPWISE_R(8.0)  /* after as many time constants the start of a lag is forgotten */

enum slipwise_status {
  SLIPWISE_OK = 0,
  SLIPWISE_BAD_WINDOW = 1,  /* an end before the start or far after it, or a number that is not finite */
  SLIPWISE_NO_COMMAND = 2   /* the oldest command that is kept is later than the start */
};

typedef struct {
  slipwise_real t, v, omega; /* [s], [m/s], [rad/s] */
} slipwise_command;

/* A ring of commands in order of time, in memory of the caller. It must reach back by the delay, and by eight lags
 * where no drive is given; commands that are planned for later may be in it too. */
typedef struct {
  slipwise_command *slots;
  int capacity, first, count;
} slipwise_commands;

typedef struct {
  slipwise_real v, omega; /* what the wheels do, before slip [m/s], [rad/s] */
} slipwise_drive;

typedef struct {
  slipwise_real start, end;    /* [s] */
  const slipwise_drive *drive; /* at the start, where measured or predicted; NULL: it follows from the commands */
  slipwise_real gx, gy;        /* gravity in the robot's frame [m/s^2]: g sin(pitch), -g cos(pitch) sin(roll) */
} slipwise_window;

typedef struct {
  slipwise_real x, y, yaw; /* seen from the robot at the start [m], [rad]; the yaw counts whole turns */
} slipwise_pose;

static inline void slipwise_commands_init(slipwise_commands *commands, slipwise_command *slots, int capacity) {
  commands->slots = slots;
  commands->capacity = capacity;
  commands->first = 0;
  commands->count = 0;
}

/* The i-th oldest command, 0 <= i < count. */
static inline const slipwise_command *slipwise_command_at(const slipwise_commands *commands, int i) {
  return &commands->slots[(commands->first + i) % commands->capacity];
}

/* Adds a command, and drops the oldest where the ring is full. Returns 0, or -1 where it is refused: it is not later
 * than the last one, or not finite. */
static inline int slipwise_command_push(slipwise_commands *commands, slipwise_real t, slipwise_real v,
                                        slipwise_real omega) {
  slipwise_command *slot;
  if (commands->capacity < 1 || !isfinite(t) || !isfinite(v) || !isfinite(omega)) {
    return -1;
  }
  if (commands->count > 0 && !(t > slipwise_command_at(commands, commands->count - 1)->t)) {
    return -1;
  }
  slot = &commands->slots[(commands->first + commands->count) % commands->capacity];
  if (commands->count == commands->capacity) {
    commands->first = (commands->first + 1) % commands->capacity;
  } else {
    ++commands->count;
  }
  slot->t = t;
  slot->v = v;
  slot->omega = omega;
  return 0;
}

/* How one channel of the drive answers its input: two lags side by side; without a slow lag there is one. */
typedef struct {
  slipwise_real lag, gain, slow_share, slow_lag;
} slipwise_response;

/* What was learned, as numbers that can be shifted. */
typedef struct {
  slipwise_real p[SLIPWISE_SLOTS(SLIPWISE_SLIP_PARAMETERS)]; /* of the slip */
  slipwise_response speed, yaw;
  slipwise_real delay_v, delay_omega, clock_offset;
} slipwise_model;

/* The learned model; `by` [SLIPWISE_PARAMETER_COUNT] is added to its parameters, lags and delays by their logarithms.
 * NULL: as learned. */
static inline slipwise_model slipwise_model_shifted(const slipwise_real *by) {
  slipwise_model model;
  model.speed.lag = SLIPWISE_LAG_V;
  model.speed.gain = SLIPWISE_GAIN_V;
  model.speed.slow_share = SLIPWISE_SLOW_SHARE_V;
  model.speed.slow_lag = SLIPWISE_SLOW_LAG_V;
  model.yaw.lag = SLIPWISE_LAG_OMEGA;
  model.yaw.gain = SLIPWISE_GAIN_OMEGA;
  model.yaw.slow_share = SLIPWISE_SLOW_SHARE_OMEGA;
  model.yaw.slow_lag = SLIPWISE_SLOW_LAG_OMEGA;
  model.delay_v = SLIPWISE_DELAY_V;
  model.delay_omega = SLIPWISE_DELAY_OMEGA;
  model.clock_offset = SLIPWISE_CLOCK_OFFSET;
  model.p[0] = SLIPWISE_P0;
  model.p[1] = SLIPWISE_P1;
  model.p[2] = SLIPWISE_P2;
  model.p[3] = SLIPWISE_P3;
  model.p[4] = SLIPWISE_P4;
  model.p[5] = SLIPWISE_P5;
  if (by) {
    model.p[0] += by[0];
    model.p[1] += by[1];
    model.p[2] += by[2];
    model.p[3] += by[3];
    model.p[4] += by[4];
    model.p[5] += by[5];
    model.speed.lag *= SLIPWISE_MATH(exp)(by[6]);
    model.yaw.lag *= SLIPWISE_MATH(exp)(by[7]);
    model.delay_v *= SLIPWISE_MATH(exp)(by[8]);
    model.delay_omega *= SLIPWISE_MATH(exp)(by[9]);
  }
  return model;
}

/* Slip rates (forward, left, turn) of a drive; they add to it. */
static inline void slipwise_slip(const slipwise_model *model, slipwise_drive drive, slipwise_real gx,
                                 slipwise_real gy, slipwise_real rate[3]) {
  const slipwise_real *const p = model->p;
  const slipwise_real v = drive.v, w = drive.omega;
  (void)v;
  (void)w;
  (void)gx;
  (void)gy;
  rate[0] = p[0] * v + p[1] * w;
  rate[1] = p[2] * v + p[3] * w;
  rate[2] = p[4] * v + p[5] * w;
}

/* The commands of one channel as the drive sees them: delayed. */
typedef struct {
  const slipwise_commands *commands;
  slipwise_real delay;
  int next, end;
} slipwise_cursor;

static inline int slipwise_count_until(const slipwise_commands *commands, slipwise_real t) {
  int low = 0, high = commands->count;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (slipwise_command_at(commands, middle)->t <= t) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

static inline slipwise_cursor slipwise_cursor_at(const slipwise_commands *commands, slipwise_real delay,
                                                 slipwise_real start, slipwise_real known_until) {
  slipwise_cursor cursor;
  cursor.commands = commands;
  cursor.delay = delay;
  cursor.next = slipwise_count_until(commands, start - delay);
  cursor.end = slipwise_count_until(commands, known_until);
  if (cursor.end < cursor.next) {
    cursor.end = cursor.next;
  }
  return cursor;
}

static inline slipwise_drive slipwise_held(const slipwise_cursor *cursor) {
  slipwise_drive held = {0, 0}; /* at rest before the first command */
  if (cursor->next > 0) {
    const slipwise_command *command = slipwise_command_at(cursor->commands, cursor->next - 1);
    held.v = command->v;
    held.omega = command->omega;
  }
  return held;
}

/* When the channel changes next, or `never`. */
static inline slipwise_real slipwise_change(const slipwise_cursor *cursor, slipwise_real never) {
  return cursor->next < cursor->end ? slipwise_command_at(cursor->commands, cursor->next)->t + cursor->delay : never;
}

/* Passes the changes until `t`. */
static inline void slipwise_catch_up(slipwise_cursor *cursor, slipwise_real t) {
  while (cursor->next < cursor->end && slipwise_change(cursor, t) <= t) {
    ++cursor->next;
  }
}

/* Moves a lag's output over a step under a held input, exactly; returns the integral of the output. */
static inline slipwise_real slipwise_lag_step(slipwise_real *output, slipwise_real input, slipwise_real lag,
                                              slipwise_real duration) {
  const slipwise_real gap = *output - input;
  const slipwise_real gone = lag > 0 ? -SLIPWISE_MATH(expm1)(-duration / lag) : SLIPWISE_R(1);
  *output = input + gap * (1 - gone);
  return input * duration + gap * lag * gone;
}

/* What the two lags of a channel put out; their sum is the drive. */
typedef struct {
  slipwise_real fast, slow;
} slipwise_channel;

static inline slipwise_real slipwise_fast_share(const slipwise_response *response) {
  return response->slow_lag > 0 ? 1 - response->slow_share : SLIPWISE_R(1);
}

static inline slipwise_channel slipwise_settled(const slipwise_response *response, slipwise_real input) {
  slipwise_channel channel;
  channel.fast = slipwise_fast_share(response) * response->gain * input;
  channel.slow = (1 - slipwise_fast_share(response)) * response->gain * input;
  return channel;
}

/* The whole was measured: what the fast part does not explain is the slow part's. */
static inline void slipwise_measured(slipwise_channel *channel, const slipwise_response *response,
                                     slipwise_real value) {
  if (response->slow_lag > 0) {
    channel->slow = value - channel->fast;
  } else {
    channel->fast = value;
  }
}

/* Moves a channel over a step; returns its integral. */
static inline slipwise_real slipwise_channel_step(slipwise_channel *channel, const slipwise_response *response,
                                                  slipwise_real input, slipwise_real duration) {
  const slipwise_channel target = slipwise_settled(response, input);
  slipwise_real integral = slipwise_lag_step(&channel->fast, target.fast, response->lag, duration);
  if (response->slow_lag > 0) {
    integral += slipwise_lag_step(&channel->slow, target.slow, response->slow_lag, duration);
  }
  return integral;
}

/* Where the robot is on its way; the heading is carried as cosine and sine. */
typedef struct {
  slipwise_pose pose;
  slipwise_real cosine, sine;
} slipwise_path;

/* The exponential of SE(2): a constant twist moves the pose by (forward, left) while it turns. */
static inline void slipwise_move(slipwise_path *path, slipwise_real forward, slipwise_real left, slipwise_real turn) {
  slipwise_real a, b, cosine, sine, x, y;
  const slipwise_real q = turn * turn;
  if (SLIPWISE_MATH(fabs)(turn) < SLIPWISE_SMALL_TURN) {
    a = 1 - q / 6 * (1 - q / 20 * (1 - q / 42));
    b = turn / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56)));
    sine = turn * a;
    cosine = 1 - turn * b;
  } else {
    const slipwise_real half_sine = SLIPWISE_MATH(sin)(turn / 2), half_cosine = SLIPWISE_MATH(cos)(turn / 2);
    sine = 2 * half_sine * half_cosine;
    cosine = 1 - 2 * half_sine * half_sine;
    a = sine / turn;
    b = 2 * half_sine * half_sine / turn;
  }
  x = a * forward - b * left;
  y = b * forward + a * left;
  path->pose.x += path->cosine * x - path->sine * y;
  path->pose.y += path->sine * x + path->cosine * y;
  path->pose.yaw += turn;
  x = path->cosine * cosine - path->sine * sine;
  path->sine = path->sine * cosine + path->cosine * sine;
  path->cosine = x;
}

/* Slip noise: power spectral densities [unit^2/s of the rate] and [unit^2 per motion], and the share of the motion that
 * stays the same all along, of (forward, left, turn). */
static const slipwise_real slipwise_noise_time[3] = {SLIPWISE_R(0.0), SLIPWISE_R(0.0), SLIPWISE_R(0.0)};
static const slipwise_real slipwise_noise_motion[3] = {SLIPWISE_R(0.001), SLIPWISE_R(0.001), SLIPWISE_R(0.001)};
static const slipwise_real slipwise_noise_share[3] = {SLIPWISE_R(0.05), SLIPWISE_R(0.05), SLIPWISE_R(0.05)};
#define SLIPWISE_TURN_RADIUS SLIPWISE_R(0.3)  /* [m] a turn of 1 rad slips like driving so far */
#define SLIPWISE_STRAIGHT_RADIUS SLIPWISE_R(5.0)  /* [m] driving turns it as an arc of this radius */
#define SLIPWISE_POSE_STD_XY SLIPWISE_R(0.02)  /* [m] of a measured pose */
#define SLIPWISE_POSE_STD_YAW SLIPWISE_R(0.01)  /* [rad] */
/* Learned factors of the noise's standard deviations in x, y and yaw. */
static const slipwise_real slipwise_noise_root[3] = {SLIPWISE_R(0.3233009543858512), SLIPWISE_R(0.35127161938915596), SLIPWISE_R(0.2712167641719302)};

/* How slip noise moves the pose, as it grows along the path. */
typedef struct {
  slipwise_real white[3][3];
  slipwise_real constant[3][3]; /* column c: of a slip in direction c that stays the same */
} slipwise_noise;

/* Carries a column of the pose's derivative on to a place farther by (x, y): a heading error moves the end sideways. */
static inline void slipwise_carry(slipwise_real column[3], slipwise_real x, slipwise_real y) {
  column[0] -= y * column[2];
  column[1] += x * column[2];
}

/* Derivative of a step's end by its tangent (forward, left, turn), [3][3] by columns. */
static inline void slipwise_by_tangent(const slipwise_path *before, const slipwise_real tangent[3],
                                       slipwise_real by[3][3]) {
  const slipwise_real f = tangent[2], q = f * f;
  slipwise_real a, b, a_slope, b_slope, x, y;
  int c;
  if (SLIPWISE_MATH(fabs)(f) < SLIPWISE_SMALL_TURN) {
    a = 1 - q / 6 * (1 - q / 20 * (1 - q / 42));
    b = f / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56)));
    a_slope = -f / 3 * (1 - q / 10 * (1 - q / 28));
    b_slope = (1 - q / 4 * (1 - q / 18 * (1 - q / 40))) / 2;
  } else {
    const slipwise_real sine = SLIPWISE_MATH(sin)(f), half = SLIPWISE_MATH(sin)(f / 2);
    a = sine / f;
    b = 2 * half * half / f;
    a_slope = (1 - 2 * half * half - a) / f;
    b_slope = (sine - b) / f;
  }
  by[0][0] = a;
  by[0][1] = b;
  by[1][0] = -b;
  by[1][1] = a;
  by[2][0] = a_slope * tangent[0] - b_slope * tangent[1];
  by[2][1] = b_slope * tangent[0] + a_slope * tangent[1];
  for (c = 0; c < 3; ++c) {
    x = by[c][0];
    y = by[c][1];
    by[c][0] = before->cosine * x - before->sine * y;
    by[c][1] = before->sine * x + before->cosine * y;
    by[c][2] = c == 2 ? SLIPWISE_R(1) : SLIPWISE_R(0);
  }
}

/* One step from `before` to `after`. */
static inline void slipwise_noise_add(slipwise_noise *noise, const slipwise_path *before, const slipwise_path *after,
                                      const slipwise_real tangent[3], slipwise_drive mean, slipwise_real duration) {
  const slipwise_real x = after->pose.x - before->pose.x, y = after->pose.y - before->pose.y;
  const slipwise_real distance = SLIPWISE_MATH(fabs)(mean.v) * duration;
  const slipwise_real turn = SLIPWISE_MATH(fabs)(mean.omega) * duration;
  const slipwise_real wheels = distance + SLIPWISE_TURN_RADIUS * turn;
  slipwise_real motion[3], by[3][3];
  int c, i, j;
  motion[0] = motion[1] = wheels;
  motion[2] = turn + distance / SLIPWISE_STRAIGHT_RADIUS;
  for (c = 0; c < 3; ++c) { /* P = F P F' by columns, then by rows */
    slipwise_carry(noise->white[c], x, y);
    slipwise_carry(noise->constant[c], x, y);
  }
  for (c = 0; c < 3; ++c) {
    noise->white[0][c] -= y * noise->white[2][c];
    noise->white[1][c] += x * noise->white[2][c];
  }
  slipwise_by_tangent(before, tangent, by);
  for (c = 0; c < 3; ++c) {
    const slipwise_real variance =
        slipwise_noise_time[c] * (wheels > 0 ? duration : SLIPWISE_R(0)) + slipwise_noise_motion[c] * motion[c];
    for (i = 0; i < 3; ++i) {
      noise->constant[c][i] += slipwise_noise_share[c] * motion[c] * by[c][i];
      for (j = 0; j < 3; ++j) {
        noise->white[i][j] += variance * by[c][i] * by[c][j];
      }
    }
  }
}
/* What a prediction carries along. */
typedef struct {
  const slipwise_model *model;
  const slipwise_window *window;
  slipwise_cursor speed_input, yaw_input;
  slipwise_channel speed, yaw_rate;
  slipwise_path path;
  slipwise_noise *noise; /* NULL where it is not asked for */
} slipwise_walk;

/* Moves the robot by a mean drive and its slip. */
static inline void slipwise_advance(slipwise_walk *walk, slipwise_drive mean, slipwise_real duration) {
  const slipwise_path before = walk->path;
  slipwise_real tangent[3];
  int i;
  slipwise_slip(walk->model, mean, walk->window->gx, walk->window->gy, tangent);
  tangent[0] += mean.v;
  tangent[2] += mean.omega;
  for (i = 0; i < 3; ++i) {
    tangent[i] *= duration;
  }
  slipwise_move(&walk->path, tangent[0], tangent[1], tangent[2]);
  if (walk->noise) {
    slipwise_noise_add(walk->noise, &before, &walk->path, tangent, mean, duration);
  }
}

/* One step of held inputs. Slip depends on the step's mean drive. */
static inline void slipwise_step(slipwise_walk *walk, slipwise_real duration, int moves) {
  const slipwise_real speed = slipwise_held(&walk->speed_input).v, yaw = slipwise_held(&walk->yaw_input).omega;
  slipwise_drive mean;
  mean.v = slipwise_channel_step(&walk->speed, &walk->model->speed, speed, duration) / duration;
  mean.omega = slipwise_channel_step(&walk->yaw_rate, &walk->model->yaw, yaw, duration) / duration;
  if (moves) {
    slipwise_advance(walk, mean, duration);
  }
}

/* Steps from `now` to `until`, ending wherever a delayed command changes. */
static inline void slipwise_cover(slipwise_walk *walk, slipwise_real now, slipwise_real until, int moves) {
  const slipwise_response *const speed = &walk->model->speed, *const yaw = &walk->model->yaw;
  const int lagging = speed->lag > 0 || yaw->lag > 0 || speed->slow_lag > 0 || yaw->slow_lag > 0;
  while (now < until) {
    slipwise_real next = slipwise_change(&walk->speed_input, until);
    const slipwise_real other = slipwise_change(&walk->yaw_input, until);
    int parts = 1, i;
    next = other < next ? other : next;
    next = next < until ? next : until;
    if (lagging && moves && next > now) { /* a lag that nobody sees needs no short steps */
      parts = (int)SLIPWISE_MATH(ceil)((next - now) / SLIPWISE_LONGEST_STEP - SLIPWISE_SAME_STEP);
      parts = parts < 1 ? 1 : parts;
    }
    for (i = 0; next > now && i < parts; ++i) {
      slipwise_step(walk, (next - now) / (slipwise_real)parts, moves);
    }
    slipwise_catch_up(&walk->speed_input, next);
    slipwise_catch_up(&walk->yaw_input, next);
    now = next > now ? next : now;
  }
}

/* The time constant that a channel's drive at the start hangs on: where it was measured, only that of a fast part beside
 * a slow one. */
static inline slipwise_real slipwise_start_lag(const slipwise_response *response, int measured) {
  if (measured) {
    return response->slow_lag > 0 ? response->lag : SLIPWISE_R(0);
  }
  return response->slow_lag > response->lag ? response->slow_lag : response->lag;
}

static inline int slipwise_is_bad(const slipwise_window *window) {
  return !isfinite(window->start) || !isfinite(window->end) || !isfinite(window->gx) || !isfinite(window->gy) ||
         !(window->end >= window->start) || !(window->end - window->start <= SLIPWISE_LONGEST_WINDOW) ||
         (window->drive && (!isfinite(window->drive->v) || !isfinite(window->drive->omega)));
}

/* One pass with one model; `walk` is what it carried along. */
static inline int slipwise_run(const slipwise_model *model, const slipwise_commands *commands,
                               const slipwise_window *window, slipwise_noise *noise, slipwise_walk *walk) {
  const slipwise_path nowhere = {{0, 0, 0}, 1, 0};
  const slipwise_real speed_lag = slipwise_start_lag(&model->speed, window->drive != 0);
  const slipwise_real yaw_lag = slipwise_start_lag(&model->yaw, window->drive != 0);
  slipwise_real start = window->start - model->clock_offset, known = start, early;
  const slipwise_real end = window->end - model->clock_offset;
  if (slipwise_is_bad(window)) {
    return SLIPWISE_BAD_WINDOW;
  }
  if (commands->count < 1 || slipwise_command_at(commands, 0)->t > window->start) {
    return SLIPWISE_NO_COMMAND;
  }
  if (window->drive) {
    known = window->start; /* by the clock of the commands, and so by that of the wheels */
  }
  early = known - SLIPWISE_SETTLED_LAGS * (speed_lag > yaw_lag ? speed_lag : yaw_lag);
  walk->window = window;
  walk->path = nowhere;
  walk->model = model;
  walk->noise = noise;
  walk->speed_input = slipwise_cursor_at(commands, model->delay_v, early, window->end);
  walk->yaw_input = slipwise_cursor_at(commands, model->delay_omega, early, window->end);
  walk->speed = slipwise_settled(&model->speed, slipwise_held(&walk->speed_input).v);
  walk->yaw_rate = slipwise_settled(&model->yaw, slipwise_held(&walk->yaw_input).omega);
  slipwise_cover(walk, early, known, 0);
  if (window->drive) {
    slipwise_measured(&walk->speed, &model->speed, window->drive->v);
    slipwise_measured(&walk->yaw_rate, &model->yaw, window->drive->omega);
  }
  if (start < known) { /* poses are stamped late: what the robot did meanwhile was measured */
    const slipwise_real until = known < end ? known : end;
    slipwise_advance(walk, *window->drive, until - start);
    start = known;
  }
  slipwise_cover(walk, known, start, 0);
  slipwise_cover(walk, start, end, 1);
  return SLIPWISE_OK;
}

/* What a pass says. */
static inline void slipwise_results(const slipwise_walk *walk, slipwise_pose *pose, slipwise_drive *drive) {
  *pose = walk->path.pose;
  if (drive) {
    drive->v = walk->speed.fast + walk->speed.slow;
    drive->omega = walk->yaw_rate.fast + walk->yaw_rate.slow;
  }
}

/* Predicts where the robot is at window->end, seen from where it is at window->start. `drive` becomes the drive at the
 * end, to start the next window with; it may be NULL. Nothing is written unless SLIPWISE_OK is returned. */
static inline int slipwise_predict(const slipwise_commands *commands, const slipwise_window *window,
                                   slipwise_pose *pose, slipwise_drive *drive) {
  const slipwise_model model = slipwise_model_shifted(0);
  slipwise_walk walk;
  const int status = slipwise_run(&model, commands, window, 0, &walk);
  if (status == SLIPWISE_OK) {
    slipwise_results(&walk, pose, drive);
  }
  return status;
}

/* The parameters' covariance is the product of these rows' transpose and themselves. */
#define SLIPWISE_ROOTS 10
static const slipwise_real slipwise_roots[SLIPWISE_SLOTS(SLIPWISE_ROOTS)]
                                         [SLIPWISE_SLOTS(SLIPWISE_PARAMETER_COUNT)] = {
    {SLIPWISE_R(1.0014396757650093e-07), SLIPWISE_R(3.6837386980732416e-07), SLIPWISE_R(-6.376040886740535e-06), SLIPWISE_R(-2.1861824250085106e-06), SLIPWISE_R(0.0010749525448088635), SLIPWISE_R(8.125829682957646e-06), SLIPWISE_R(-1.5113151470086414e-07), SLIPWISE_R(2.0292720175515483e-06), SLIPWISE_R(-4.773896668626339e-09), SLIPWISE_R(2.3181308063076742e-07)},
    {SLIPWISE_R(-0.00260243442901345), SLIPWISE_R(4.546154756338419e-05), SLIPWISE_R(5.498799471728269e-05), SLIPWISE_R(2.785600821134112e-05), SLIPWISE_R(5.162242411756191e-07), SLIPWISE_R(1.2856307125888175e-05), SLIPWISE_R(1.724530967252225e-05), SLIPWISE_R(-7.108132995740115e-07), SLIPWISE_R(-9.950573889767321e-07), SLIPWISE_R(1.4904363726876737e-07)},
    {SLIPWISE_R(-5.715378198575926e-05), SLIPWISE_R(-1.2327420385299556e-05), SLIPWISE_R(-0.002726558385970368), SLIPWISE_R(4.2187013365028384e-05), SLIPWISE_R(-1.633114234692654e-05), SLIPWISE_R(3.312149137751096e-05), SLIPWISE_R(9.311354653529634e-06), SLIPWISE_R(2.5689019298846634e-06), SLIPWISE_R(1.9527177953045094e-06), SLIPWISE_R(4.850989416183838e-07)},
    {SLIPWISE_R(-2.1536591965053736e-05), SLIPWISE_R(-0.00012076387756507125), SLIPWISE_R(-4.58750662482202e-05), SLIPWISE_R(0.00012272552088239021), SLIPWISE_R(3.0197564108855418e-05), SLIPWISE_R(-0.004004767324200784), SLIPWISE_R(3.252772035217953e-06), SLIPWISE_R(5.259126749066593e-05), SLIPWISE_R(-4.2277333814779127e-07), SLIPWISE_R(-1.1567524373066403e-05)},
    {SLIPWISE_R(-9.342695532047718e-05), SLIPWISE_R(-0.00437406262128472), SLIPWISE_R(-3.310630531626477e-06), SLIPWISE_R(-0.0017193135649154825), SLIPWISE_R(-2.624235827185011e-06), SLIPWISE_R(8.00687404000995e-05), SLIPWISE_R(0.0001609494981415634), SLIPWISE_R(1.6856954255550595e-05), SLIPWISE_R(3.099967129092841e-06), SLIPWISE_R(5.3523046304524965e-06)},
    {SLIPWISE_R(-2.0823163302919903e-05), SLIPWISE_R(0.0018111311699632886), SLIPWISE_R(-8.165719600432614e-05), SLIPWISE_R(-0.004619424877698377), SLIPWISE_R(-9.113765410918361e-06), SLIPWISE_R(-0.00019472434287613754), SLIPWISE_R(-4.7595256751620115e-05), SLIPWISE_R(4.1659218639716536e-05), SLIPWISE_R(2.101914949257817e-06), SLIPWISE_R(1.207000786767927e-05)},
    {SLIPWISE_R(-9.232863757222315e-05), SLIPWISE_R(-0.0004483711481849215), SLIPWISE_R(-4.1608237489099735e-05), SLIPWISE_R(-4.4973446297401085e-05), SLIPWISE_R(-2.0366267104372857e-06), SLIPWISE_R(3.3336700014220688e-06), SLIPWISE_R(-0.012679881693789304), SLIPWISE_R(2.2356568355542508e-05), SLIPWISE_R(-0.002298885916051141), SLIPWISE_R(1.3575216365407378e-06)},
    {SLIPWISE_R(-8.938382636149379e-07), SLIPWISE_R(1.486731310867976e-05), SLIPWISE_R(2.5433005577348088e-05), SLIPWISE_R(0.00018321431172396252), SLIPWISE_R(-3.933347327690956e-05), SLIPWISE_R(0.00024889275186781005), SLIPWISE_R(3.3327922673557e-05), SLIPWISE_R(0.019598649243762183), SLIPWISE_R(2.933914847208673e-06), SLIPWISE_R(0.0045318067012272345)},
    {SLIPWISE_R(-0.00016157852184457255), SLIPWISE_R(-0.000568652099740059), SLIPWISE_R(1.5314771468592584e-05), SLIPWISE_R(7.071052772966711e-07), SLIPWISE_R(-1.7146371255337965e-06), SLIPWISE_R(-5.8465653893593645e-06), SLIPWISE_R(-0.017387599785330547), SLIPWISE_R(2.960205070366074e-05), SLIPWISE_R(0.09602150638923843), SLIPWISE_R(-6.028676692982363e-05)},
    {SLIPWISE_R(-1.970251965271143e-05), SLIPWISE_R(1.8333499469639105e-05), SLIPWISE_R(2.212492945870106e-05), SLIPWISE_R(-0.0001591506296562651), SLIPWISE_R(-5.66023630066196e-05), SLIPWISE_R(0.0012538524399875299), SLIPWISE_R(8.825950485641329e-05), SLIPWISE_R(0.0491569975740841), SLIPWISE_R(-0.00013253697317133434), SLIPWISE_R(-0.2126523404201265)}
};
/* Slip parameters that wander about what was learned: which, and the variance that a process of each time constant [s]
 * gives them. Their mean over a prediction has another normal deviate each. */
#define SLIPWISE_WANDERING 0
#define SLIPWISE_WANDER_TIMES 0
static const int slipwise_wandering[SLIPWISE_SLOTS(SLIPWISE_WANDERING)] = {0};
static const slipwise_real slipwise_wander_times[SLIPWISE_SLOTS(SLIPWISE_WANDER_TIMES)] = {SLIPWISE_R(0.0)};
static const slipwise_real slipwise_wander_variance[SLIPWISE_SLOTS(SLIPWISE_WANDERING)]
                                                   [SLIPWISE_SLOTS(SLIPWISE_WANDER_TIMES)] = {
    {SLIPWISE_R(0)}
};
/* What held-out predictions of these horizons [s] needed: ln of the growth of the covariance, and of the degrees of
 * freedom of the Student t that has it. */
#define SLIPWISE_TAILS 3
static const slipwise_real slipwise_tails[SLIPWISE_TAILS][3] = {{SLIPWISE_R(1.0), SLIPWISE_R(-0.7512636919302976), SLIPWISE_R(2.0794415416798357)}, {SLIPWISE_R(2.0), SLIPWISE_R(-0.8771258787375703), SLIPWISE_R(2.0794415416798357)}, {SLIPWISE_R(5.0), SLIPWISE_R(-0.9880205973800916), SLIPWISE_R(2.0794415416798357)}};

/* Growth of the covariance, and degrees of freedom, at a horizon [s]: between those judged by their logarithms. */
static inline void slipwise_tail(slipwise_real horizon, slipwise_real *growth, slipwise_real *dof) {
  const slipwise_real(*at)[3] = slipwise_tails;
  slipwise_real share = 0;
  int i = 0;
  while (i + 2 < SLIPWISE_TAILS && horizon > at[i + 1][0]) {
    ++i;
  }
  if (SLIPWISE_TAILS > 1) {
    share = (horizon - at[i][0]) / (at[i + 1][0] - at[i][0]);
    share = share < 0 ? SLIPWISE_R(0) : share > 1 ? SLIPWISE_R(1) : share;
    *growth = SLIPWISE_MATH(exp)(at[i][1] + share * (at[i + 1][1] - at[i][1]));
    *dof = SLIPWISE_MATH(exp)(at[i][2] + share * (at[i + 1][2] - at[i][2]));
  } else {
    *growth = SLIPWISE_MATH(exp)(at[0][1]);
    *dof = SLIPWISE_MATH(exp)(at[0][2]);
  }
}

/* Standard deviation of the mean of such a parameter over a prediction of this horizon [s]. */
static inline slipwise_real slipwise_wander_std(int place, slipwise_real horizon) {
  slipwise_real variance = 0;
  int i;
  for (i = 0; i < SLIPWISE_WANDER_TIMES; ++i) {
    const slipwise_real s = horizon / slipwise_wander_times[i];
    const slipwise_real mean = s < SLIPWISE_SMALL_SPAN ? 1 - s / 3 * (1 - s / 4 * (1 - s / 5))
                                                       : 2 / s * (1 + SLIPWISE_MATH(expm1)(-s) / s);
    variance += mean * slipwise_wander_variance[place][i];
  }
  return SLIPWISE_MATH(sqrt)(variance);
}

/* Adds a a'. */
static inline void slipwise_add_square(slipwise_real sum[3][3], const slipwise_real a[3]) {
  int i, j;
  for (i = 0; i < 3; ++i) {
    for (j = 0; j < 3; ++j) {
      sum[i][j] += a[i] * a[j];
    }
  }
}

/* As slipwise_predict, with the covariance of (x, y, yaw) that slipwise.predict states: learned parameters, slip that
 * wanders about them, slip noise, the noise of two measured poses, and growth. It costs 2 * (SLIPWISE_ROOTS +
 * SLIPWISE_WANDERING) + 1 predictions. */
static inline int slipwise_predict_covariance(const slipwise_commands *commands, const slipwise_window *window,
                                              slipwise_pose *pose, slipwise_drive *drive,
                                              slipwise_real covariance[3][3]) {
  const slipwise_model model = slipwise_model_shifted(0);
  slipwise_real parameters[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, noise_sum[3][3];
  slipwise_real by[SLIPWISE_SLOTS(SLIPWISE_PARAMETER_COUNT)], growth, dof;
  slipwise_noise noise = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  slipwise_walk walk;
  int root, i, j, side;
  const int status = slipwise_run(&model, commands, window, &noise, &walk);
  if (status != SLIPWISE_OK) {
    return status;
  }
  for (root = 0; root < SLIPWISE_ROOTS + SLIPWISE_WANDERING; ++root) { /* derivatives along the roots: central differences */
    slipwise_real change[3] = {0, 0, 0};
    for (side = -1; side <= 1; side += 2) {
      slipwise_walk shifted;
      slipwise_model other;
      for (i = 0; i < SLIPWISE_PARAMETER_COUNT; ++i) {
        by[i] = root < SLIPWISE_ROOTS ? (slipwise_real)side * SLIPWISE_DIFFERENCE * slipwise_roots[root][i] : 0;
      }
      if (root >= SLIPWISE_ROOTS) {
        const int place = root - SLIPWISE_ROOTS;
        by[slipwise_wandering[place]] = (slipwise_real)side * SLIPWISE_DIFFERENCE *
                                        slipwise_wander_std(place, window->end - window->start);
      }
      other = slipwise_model_shifted(by);
      slipwise_run(&other, commands, window, 0, &shifted);
      change[0] += (slipwise_real)side * (shifted.path.pose.x - walk.path.pose.x);
      change[1] += (slipwise_real)side * (shifted.path.pose.y - walk.path.pose.y);
      change[2] += (slipwise_real)side * (shifted.path.pose.yaw - walk.path.pose.yaw);
    }
    for (i = 0; i < 3; ++i) {
      change[i] /= 2 * SLIPWISE_DIFFERENCE;
    }
    slipwise_add_square(parameters, change);
  }
  for (i = 0; i < 3; ++i) {
    for (j = 0; j < 3; ++j) {
      noise_sum[i][j] = noise.white[i][j];
    }
  }
  for (i = 0; i < 3; ++i) {
    slipwise_add_square(noise_sum, noise.constant[i]);
  }
  { /* both poses are measured; a start turned too far left moves the end right and back */
    const slipwise_real xy[2][3] = {{SLIPWISE_POSE_STD_XY, 0, 0}, {0, SLIPWISE_POSE_STD_XY, 0}};
    const slipwise_real yaw = SLIPWISE_POSE_STD_YAW;
    const slipwise_real turned[3] = {yaw * walk.path.pose.y, -yaw * walk.path.pose.x, -yaw};
    const slipwise_real own[3] = {0, 0, SLIPWISE_POSE_STD_YAW};
    for (i = 0; i < 2; ++i) {
      slipwise_add_square(noise_sum, xy[i]);
      slipwise_add_square(noise_sum, xy[i]);
    }
    slipwise_add_square(noise_sum, turned);
    slipwise_add_square(noise_sum, own);
  }
  slipwise_tail(window->end - window->start, &growth, &dof);
  for (i = 0; i < 3; ++i) {
    for (j = 0; j < 3; ++j) {
      covariance[i][j] =
          growth * (parameters[i][j] + slipwise_noise_root[i] * slipwise_noise_root[j] * noise_sum[i][j]);
    }
  }
  slipwise_results(&walk, pose, drive);
  return SLIPWISE_OK;
}
#endif /* SLIPWISE_MODEL_H */
