/*
 * slipwise 0.1.0, model model.yaml (sha256 d2656633034e22ce), learned by slipwise 0.1.0
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
#else
typedef float slipwise_real;
#define SLIPWISE_MATH(function) function##f
#define SLIPWISE_SMALL_TURN 0.35f
#endif
#define SLIPWISE_R(number) ((slipwise_real)(number))

/* What was learned. Inputs are commanded speeds. */
#define SLIPWISE_DELAY_V SLIPWISE_R(0.17979255394262977)  /* [s] transport delay of the speed */
#define SLIPWISE_GAIN_V SLIPWISE_R(1.0)  /* drive over input, of the speed */
#define SLIPWISE_LAG_V SLIPWISE_R(0.8279071739031711)  /* [s] time constant of the speed */
#define SLIPWISE_SLOW_SHARE_V SLIPWISE_R(0.0)  /* share of the speed that follows slowly */
#define SLIPWISE_SLOW_LAG_V SLIPWISE_R(0.0)  /* [s] its time constant; 0 where there is none */
#define SLIPWISE_DELAY_OMEGA SLIPWISE_R(0.155888376852673)  /* [s] transport delay of the yaw rate */
#define SLIPWISE_GAIN_OMEGA SLIPWISE_R(1.0)  /* drive over input, of the yaw rate */
#define SLIPWISE_LAG_OMEGA SLIPWISE_R(0.8526373815534295)  /* [s] time constant of the yaw rate */
#define SLIPWISE_SLOW_SHARE_OMEGA SLIPWISE_R(0.0)  /* share of the yaw rate that follows slowly */
#define SLIPWISE_SLOW_LAG_OMEGA SLIPWISE_R(0.0)  /* [s] its time constant; 0 where there is none */
#define SLIPWISE_CLOCK_OFFSET SLIPWISE_R(0.0)  /* [s] poses are stamped this much later than the inputs */
#define SLIPWISE_P0 SLIPWISE_R(-0.013530321551158315)  /* lon.V [m/s per V], +- 0.0026 */
#define SLIPWISE_P1 SLIPWISE_R(-0.003941739370395638)  /* lon.w [m/s per w], +- 0.0048 */
#define SLIPWISE_P2 SLIPWISE_R(0.0002318653830289367)  /* lat.V [m/s per V], +- 0.0027 */
#define SLIPWISE_P3 SLIPWISE_R(-0.01587659421056705)  /* lat.w [m/s per w], +- 0.0049 */
#define SLIPWISE_P4 SLIPWISE_R(-0.00010030030672093808)  /* ang.V [rad/s per V], +- 0.0011 */
#define SLIPWISE_P5 SLIPWISE_R(-0.3829469452501794)  /* ang.w [rad/s per w], +- 0.0042 */
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
#define SLIPWISE_HAS_DYNAMICS 1
#define SLIPWISE_HAS_RESPONSE 0
#define SLIPWISE_HAS_CLOCK_OFFSET 0
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

/* Slip rates (forward, left, turn) of a drive; they add to it. */
static inline void slipwise_slip(slipwise_real v, slipwise_real w, slipwise_real gx, slipwise_real gy,
                                 slipwise_real rate[3]) {
  (void)v;
  (void)w;
  (void)gx;
  (void)gy;
  rate[0] = SLIPWISE_P0 * v + SLIPWISE_P1 * w;
  rate[1] = SLIPWISE_P2 * v + SLIPWISE_P3 * w;
  rate[2] = SLIPWISE_P4 * v + SLIPWISE_P5 * w;
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

/* Moves a lag's output over a step under a held input, exactly; returns the integral of the output. */
static inline slipwise_real slipwise_lag_step(slipwise_real *output, slipwise_real input, slipwise_real lag,
                                              slipwise_real duration) {
  const slipwise_real gap = *output - input;
  const slipwise_real gone = lag > 0 ? -SLIPWISE_MATH(expm1)(-duration / lag) : SLIPWISE_R(1);
  *output = input + gap * (1 - gone);
  return input * duration + gap * lag * gone;
}

/* How one channel of the drive answers its input: two lags side by side; without a slow lag there is one. */
typedef struct {
  slipwise_real lag, gain, slow_share, slow_lag;
} slipwise_response;

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

/* What a prediction carries along. */
typedef struct {
  const slipwise_window *window;
  slipwise_cursor speed_input, yaw_input;
  slipwise_response speed_response, yaw_response;
  slipwise_channel speed, yaw_rate;
  slipwise_path path;
} slipwise_walk;

/* Moves the robot by a mean drive and its slip. */
static inline void slipwise_advance(slipwise_walk *walk, slipwise_drive mean, slipwise_real duration) {
  slipwise_real rate[3];
  slipwise_slip(mean.v, mean.omega, walk->window->gx, walk->window->gy, rate);
  slipwise_move(&walk->path, (mean.v + rate[0]) * duration, rate[1] * duration, (mean.omega + rate[2]) * duration);
}

/* One step of held inputs. Slip depends on the step's mean drive. */
static inline void slipwise_step(slipwise_walk *walk, slipwise_real duration, int moves) {
  const slipwise_real speed = slipwise_held(&walk->speed_input).v, yaw = slipwise_held(&walk->yaw_input).omega;
  slipwise_drive mean;
  mean.v = slipwise_channel_step(&walk->speed, &walk->speed_response, speed, duration) / duration;
  mean.omega = slipwise_channel_step(&walk->yaw_rate, &walk->yaw_response, yaw, duration) / duration;
  if (moves) {
    slipwise_advance(walk, mean, duration);
  }
}

/* Steps from `now` to `until`, ending wherever a delayed command changes. */
static inline void slipwise_cover(slipwise_walk *walk, slipwise_real now, slipwise_real until, int moves) {
  const int lagging = SLIPWISE_LAG_V > 0 || SLIPWISE_LAG_OMEGA > 0 || SLIPWISE_SLOW_LAG_V > 0 ||
                      SLIPWISE_SLOW_LAG_OMEGA > 0;
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
    while (walk->speed_input.next < walk->speed_input.end && slipwise_change(&walk->speed_input, next) <= next) {
      ++walk->speed_input.next;
    }
    while (walk->yaw_input.next < walk->yaw_input.end && slipwise_change(&walk->yaw_input, next) <= next) {
      ++walk->yaw_input.next;
    }
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

/* Predicts where the robot is at window->end, seen from where it is at window->start. `drive` becomes the drive at the
 * end, to start the next window with; it may be NULL. Nothing is written unless SLIPWISE_OK is returned. */
static inline int slipwise_predict(const slipwise_commands *commands, const slipwise_window *window,
                                   slipwise_pose *pose, slipwise_drive *drive) {
  const slipwise_response speed = {SLIPWISE_LAG_V, SLIPWISE_GAIN_V, SLIPWISE_SLOW_SHARE_V, SLIPWISE_SLOW_LAG_V};
  const slipwise_response yaw = {SLIPWISE_LAG_OMEGA, SLIPWISE_GAIN_OMEGA, SLIPWISE_SLOW_SHARE_OMEGA,
                                 SLIPWISE_SLOW_LAG_OMEGA};
  const slipwise_path nowhere = {{0, 0, 0}, 1, 0};
  const slipwise_real speed_lag = slipwise_start_lag(&speed, window->drive != 0);
  const slipwise_real yaw_lag = slipwise_start_lag(&yaw, window->drive != 0);
  slipwise_real start = window->start - SLIPWISE_CLOCK_OFFSET, known = start, early;
  const slipwise_real end = window->end - SLIPWISE_CLOCK_OFFSET;
  slipwise_walk walk;
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
  walk.window = window;
  walk.path = nowhere;
  walk.speed_response = speed;
  walk.yaw_response = yaw;
  walk.speed_input = slipwise_cursor_at(commands, SLIPWISE_DELAY_V, early, window->end);
  walk.yaw_input = slipwise_cursor_at(commands, SLIPWISE_DELAY_OMEGA, early, window->end);
  walk.speed = slipwise_settled(&speed, slipwise_held(&walk.speed_input).v);
  walk.yaw_rate = slipwise_settled(&yaw, slipwise_held(&walk.yaw_input).omega);
  slipwise_cover(&walk, early, known, 0);
  if (window->drive) {
    slipwise_measured(&walk.speed, &speed, window->drive->v);
    slipwise_measured(&walk.yaw_rate, &yaw, window->drive->omega);
  }
  if (start < known) { /* poses are stamped late: what the robot did meanwhile was measured */
    const slipwise_real until = known < end ? known : end;
    slipwise_advance(&walk, *window->drive, until - start);
    start = known;
  }
  slipwise_cover(&walk, known, start, 0);
  slipwise_cover(&walk, start, end, 1);
  *pose = walk.path.pose;
  if (drive) {
    drive->v = walk.speed.fast + walk.speed.slow;
    drive->omega = walk.yaw_rate.fast + walk.yaw_rate.slow;
  }
  return SLIPWISE_OK;
}

#endif /* SLIPWISE_MODEL_H */
