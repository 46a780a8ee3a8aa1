@ORIGIN@
/* SPDX-License-Identifier: Apache-2.0
 *
 * The learned motion model, for microcontrollers and planners: C99 or C++, no memory of its own, nothing but <math.h>.
 *
 *   slipwise_command slots[64];
 *   slipwise_commands commands;
 *   slipwise_commands_init(&commands, slots, 64);
 *   slipwise_command_push(&commands, 0.0f, 1.0f,@SIDE{ 0.2f,}@ 0.3f);         // t [s], v [m/s],@SIDE{ vy [m/s],}@ omega [rad/s]; held from t on
 *   slipwise_window window = {0.0f, 5.0f, 0, 0.0f, 0.0f};       // from 0 s to 5 s, drive follows from the commands
 *   slipwise_pose pose;
 *   if (slipwise_predict(&commands, &window, &pose, 0) == SLIPWISE_OK) { ... pose.x, pose.y, pose.yaw ... }
 *   slipwise_real covariance[3][3];                             // of x, y, yaw: m^2, m rad, rad^2
 *   slipwise_predict_covariance(&commands, &window, &pose, 0, covariance);
 *
 * x forward, y left, counter-clockwise; SI units. Numbers are float; define SLIPWISE_DOUBLE before including this for
 * double. In float keep times small: start them again when the robot starts.
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

/* What was learned. Inputs are @INPUT@. */
@CONSTANTS@
/* The range that the log held; beyond it the model is a guess. */
@RANGE@
/* The same model for the C++ library: terms of the slip basis, parts of the actuator, and the parameter vector. */
@LIBRARY@
@LIMITS@
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
  slipwise_real t, v,@SIDE{ vy,}@ omega; /* [s], [m/s],@SIDE{ [m/s] to the left,}@ [rad/s]@STEER{; in a ring, the curvature [1/m]}@ */
} slipwise_command;

/* A ring of commands in order of time, in memory of the caller. It must reach back by the delay, and by eight lags
 * where no drive is given or a channel has two lags; commands that are planned for later may be in it too. Before the
 * oldest one the drive is at rest or, where it is given and that command does not act yet, goes on as it does. */
typedef struct {
  slipwise_command *slots;
  int capacity, first, count;
} slipwise_commands;

typedef struct {
  slipwise_real v,@SIDE{ vy,}@ omega; /* what the wheels do, before slip [m/s],@SIDE{ [m/s],}@ [rad/s] */
} slipwise_drive;

typedef struct {
  slipwise_real start, end;    /* [s] by the clock of the commands, as the robot is then: not as late poses say */
  const slipwise_drive *drive; /* at the start, where measured or predicted; NULL: from rest, by the commands */
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

@STEER{/* A drive that steers: its second channel is the curvature of its path [1/m]; the yaw rate follows from it. A command
 * that stands with turned wheels has a speed of SLIPWISE_STANDING_SPEED and a yaw rate of so much times the curvature;
 * one of zeros stands with straight wheels. */
#define SLIPWISE_STANDING_SPEED SLIPWISE_R(@STANDING@) /* [m/s] */
#define SLIPWISE_SHOWS_CURVATURE SLIPWISE_R(@SHOWS@)   /* [m/s] a slower drive does not show its curvature */
#define SLIPWISE_SHARPEST (SLIPWISE_R(@TANGENT@) / SLIPWISE_WHEELBASE) /* [1/m] */

static inline slipwise_real slipwise_curvature(slipwise_real v, slipwise_real omega) {
  const slipwise_real curvature = v > 0 || v < 0 ? omega / v : SLIPWISE_R(0);
  return curvature > SLIPWISE_SHARPEST ? SLIPWISE_SHARPEST : curvature < -SLIPWISE_SHARPEST ? -SLIPWISE_SHARPEST : curvature;
}

}@/* Adds a command, and drops the oldest where the ring is full. Returns 0, or -1 where it is refused: it is not later
 * than the last one, or not finite. */
static inline int slipwise_command_push(slipwise_commands *commands, slipwise_real t, slipwise_real v,
                                        @SIDE{slipwise_real vy, }@slipwise_real omega) {
  slipwise_command *slot;
  if (commands->capacity < 1 || !isfinite(t) || !isfinite(v) ||@SIDE{ !isfinite(vy) ||}@ !isfinite(omega)) {
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
@SIDE{  slot->vy = vy;
}@  slot->omega = omega;
@STEER{  slot->omega = slipwise_curvature(v, omega);
  slot->v = SLIPWISE_MATH(fabs)(v) > SLIPWISE_STANDING_SPEED ? v : SLIPWISE_R(0);
}@  return 0;
}

/* How one channel of the drive answers its input: two lags side by side; without a slow lag there is one. */
typedef struct {
  slipwise_real time_constant, gain, slow_fraction, slow_time_constant;
} slipwise_response;

/* What was learned, as numbers that can be shifted. */
typedef struct {
  slipwise_real p[SLIPWISE_SLOTS(SLIPWISE_SLIP_PARAMETERS)]; /* of the slip */
  slipwise_response speed, yaw;
  slipwise_real delay_v, delay_omega;
} slipwise_model;

/* The learned model; `by` [SLIPWISE_PARAMETER_COUNT] is added to its parameters, lags and delays by their logarithms.
 * NULL: as learned. */
static inline slipwise_model slipwise_model_shifted(const slipwise_real *by) {
  slipwise_model model;
  model.speed.time_constant = SLIPWISE_TIME_CONSTANT_V;
  model.speed.gain = SLIPWISE_GAIN_V;
  model.speed.slow_fraction = SLIPWISE_SLOW_FRACTION_V;
  model.speed.slow_time_constant = SLIPWISE_SLOW_TIME_CONSTANT_V;
  model.yaw.time_constant = SLIPWISE_TIME_CONSTANT_OMEGA;
  model.yaw.gain = SLIPWISE_GAIN_OMEGA;
  model.yaw.slow_fraction = SLIPWISE_SLOW_FRACTION_OMEGA;
  model.yaw.slow_time_constant = SLIPWISE_SLOW_TIME_CONSTANT_OMEGA;
  model.delay_v = SLIPWISE_DELAY_V;
  model.delay_omega = SLIPWISE_DELAY_OMEGA;
@LEARNED@
  if (by) {
@SHIFTS@
  }
  return model;
}

/* Slip rates (forward, left, turn) of a drive; they add to it. */
static inline void slipwise_slip(const slipwise_model *model, slipwise_drive drive, slipwise_real gx,
                                 slipwise_real gy, slipwise_real rate[3]) {
  const slipwise_real *const p = model->p;
  const slipwise_real v = drive.v,@SIDE{ vy = drive.vy,}@ w = drive.omega;
@SLIP@
}

/* A drive that was measured: which input keeps it, and until when commands act by then, by their stamps. */
typedef struct {
  int measured;
  slipwise_drive keeping;
  slipwise_real v_until, omega_until;
} slipwise_start;

@CURSOR@
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

static inline slipwise_real slipwise_fast_fraction(const slipwise_response *response) {
  return response->slow_time_constant > 0 ? 1 - response->slow_fraction : SLIPWISE_R(1);
}

static inline slipwise_channel slipwise_settled(const slipwise_response *response, slipwise_real input) {
  slipwise_channel channel;
  channel.fast = slipwise_fast_fraction(response) * response->gain * input;
  channel.slow = (1 - slipwise_fast_fraction(response)) * response->gain * input;
  return channel;
}

static inline slipwise_real slipwise_lesser(slipwise_real a, slipwise_real b) { return a < b ? a : b; }
static inline slipwise_real slipwise_greater(slipwise_real a, slipwise_real b) { return a > b ? a : b; }

/* The whole was measured while `input` acts, or before any does: then the channel is settled. The slow mode is what the
 * fast one does not explain, within the range of what it would be by the inputs alone, where it settles, and its
 * fraction of the value: so no inputs carry the drive beyond the value, themselves and the inputs before. */
static inline void slipwise_measured(slipwise_channel *channel, const slipwise_response *response,
                                     slipwise_real value, slipwise_real input, int acts) {
  const slipwise_real fast_fraction = slipwise_fast_fraction(response);
  if (!(response->slow_time_constant > 0)) {
    channel->fast = value;
  } else if (!acts) {
    channel->fast = fast_fraction * value;
    channel->slow = (1 - fast_fraction) * value;
  } else {
    const slipwise_channel settled = slipwise_settled(response, input);
    const slipwise_real left = value - channel->fast, share = (1 - fast_fraction) * value;
    const slipwise_real low = slipwise_lesser(channel->slow, slipwise_lesser(settled.slow, share));
    const slipwise_real high = slipwise_greater(channel->slow, slipwise_greater(settled.slow, share));
    channel->slow = slipwise_lesser(slipwise_greater(left, low), high);
    channel->fast = value - channel->slow;
  }
}

/* The input that keeps a channel as it is. */
static inline slipwise_real slipwise_keeping(const slipwise_response *response, slipwise_real value) {
  return response->gain < 0 || response->gain > 0 ? value / response->gain : SLIPWISE_R(0);
}

/* Moves a channel over a step; returns its integral. */
static inline slipwise_real slipwise_channel_step(slipwise_channel *channel, const slipwise_response *response,
                                                  slipwise_real input, slipwise_real duration) {
  const slipwise_channel target = slipwise_settled(response, input);
  slipwise_real integral = slipwise_lag_step(&channel->fast, target.fast, response->time_constant, duration);
  if (response->slow_time_constant > 0) {
    integral += slipwise_lag_step(&channel->slow, target.slow, response->slow_time_constant, duration);
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

@NOISE@
/* What a prediction carries along. */
typedef struct {
  const slipwise_model *model;
  const slipwise_window *window;
  slipwise_cursor speed_input, yaw_input;
  slipwise_channel speed, yaw_rate@SIDE{, side}@;
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
@SIDE{  tangent[1] += mean.vy;
}@  tangent[2] += mean.omega;
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
  mean.v = walk->speed.fast + walk->speed.slow;
@SIDE{  mean.vy = walk->side.fast + walk->side.slow;
}@  mean.omega = walk->yaw_rate.fast + walk->yaw_rate.slow;
  if (!walk->window->drive || slipwise_acts(&walk->speed_input)) {
    mean.v = slipwise_channel_step(&walk->speed, &walk->model->speed, speed, duration) / duration;
@SIDE{    mean.vy = slipwise_channel_step(&walk->side, &walk->model->speed, slipwise_held(&walk->speed_input).vy, duration) / duration;
}@  }
  if (!walk->window->drive || slipwise_acts(&walk->yaw_input)) {
    mean.omega = slipwise_channel_step(&walk->yaw_rate, &walk->model->yaw, yaw, duration) / duration;
  }
@STEER{  mean.omega *= mean.v; /* a curvature until here */
}@  if (moves) {
    slipwise_advance(walk, mean, duration);
  }
}

/* Steps from `now` to `until`, ending wherever a delayed command changes. */
static inline void slipwise_cover(slipwise_walk *walk, slipwise_real now, slipwise_real until, int moves) {
  const slipwise_response *const speed = &walk->model->speed, *const yaw = &walk->model->yaw;
  const int lagging = speed->time_constant > 0 || yaw->time_constant > 0 || speed->slow_time_constant > 0 || yaw->slow_time_constant > 0;
  while (now < until) {
    slipwise_real next = slipwise_change(&walk->speed_input, until);
    const slipwise_real other = slipwise_change(&walk->yaw_input, until);
    int parts = 1, i;
    next = other < next ? other : next;
    next = next < until ? next : until;
    if (lagging && moves && next > now) { /* a lag without effect needs no short steps */
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

/* The time constant that a channel's drive at the start hangs on: where it was measured, only those of two lags. */
static inline slipwise_real slipwise_start_lag(const slipwise_response *response, int measured) {
  if (measured && !(response->slow_time_constant > 0)) {
    return SLIPWISE_R(0);
  }
  return response->slow_time_constant > response->time_constant ? response->slow_time_constant : response->time_constant;
}

static inline slipwise_start slipwise_start_of(const slipwise_model *model, const slipwise_drive *drive,
                                               slipwise_real known) {
  slipwise_start start;
  start.measured = drive != 0;
  start.keeping.v = drive ? slipwise_keeping(&model->speed, drive->v) : SLIPWISE_R(0);
@SIDE{  start.keeping.vy = drive ? slipwise_keeping(&model->speed, drive->vy) : SLIPWISE_R(0);
}@  start.keeping.omega = drive ? slipwise_keeping(&model->yaw, drive->omega) : SLIPWISE_R(0);
  start.v_until = known - model->delay_v;
  start.omega_until = known - model->delay_omega;
  return start;
}

static inline int slipwise_is_bad(const slipwise_window *window) {
  return !isfinite(window->start) || !isfinite(window->end) || !isfinite(window->gx) || !isfinite(window->gy) ||
         !(window->end >= window->start) || !(window->end - window->start <= SLIPWISE_LONGEST_WINDOW) ||
         (window->drive && (!isfinite(window->drive->v) ||@SIDE{ !isfinite(window->drive->vy) ||}@ !isfinite(window->drive->omega)));
}

/* One pass with one model; `walk` is what it carried along. */
static inline int slipwise_run(const slipwise_model *model, const slipwise_commands *commands,
                               const slipwise_window *window, slipwise_noise *noise, slipwise_walk *walk) {
  const slipwise_path nowhere = {{0, 0, 0}, 1, 0};
  const slipwise_real speed_lag = slipwise_start_lag(&model->speed, window->drive != 0);
  const slipwise_real yaw_lag = slipwise_start_lag(&model->yaw, @STEER{0}@@TURNS{window->drive != 0}@);
  const slipwise_real start = window->start;
  slipwise_real early;
  slipwise_start at;
  if (slipwise_is_bad(window)) {
    return SLIPWISE_BAD_WINDOW;
  }
  if (commands->count < 1 || slipwise_command_at(commands, 0)->t > window->start) {
    return SLIPWISE_NO_COMMAND;
  }
  early = start - SLIPWISE_SETTLED_LAGS * (speed_lag > yaw_lag ? speed_lag : yaw_lag);
  walk->window = window;
  walk->path = nowhere;
  walk->model = model;
  walk->noise = noise;
  at = slipwise_start_of(model, window->drive, start);
  walk->speed_input = slipwise_cursor_at(commands, &at, model->delay_v, early, window->end);
  walk->yaw_input = slipwise_cursor_at(commands, &at, model->delay_omega, early, window->end);
  walk->speed = slipwise_settled(&model->speed, slipwise_held(&walk->speed_input).v);
@SIDE{  walk->side = slipwise_settled(&model->speed, slipwise_held(&walk->speed_input).vy);
}@  walk->yaw_rate = slipwise_settled(&model->yaw, slipwise_held(&walk->yaw_input).omega);
  slipwise_cover(walk, early, start, 0);
  if (window->drive) {
    slipwise_measured(&walk->speed, &model->speed, window->drive->v, slipwise_held(&walk->speed_input).v,
                      slipwise_acts(&walk->speed_input));
@SIDE{    slipwise_measured(&walk->side, &model->speed, window->drive->vy, slipwise_held(&walk->speed_input).vy,
                      slipwise_acts(&walk->speed_input));
}@@TURNS{    slipwise_measured(&walk->yaw_rate, &model->yaw, window->drive->omega, slipwise_held(&walk->yaw_input).omega,
                      slipwise_acts(&walk->yaw_input));
}@@STEER{    if (!slipwise_acts(&walk->yaw_input) && SLIPWISE_MATH(fabs)(window->drive->v) >= SLIPWISE_SHOWS_CURVATURE) {
      slipwise_measured(&walk->yaw_rate, &model->yaw, slipwise_curvature(window->drive->v, window->drive->omega), 0, 0);
    } /* else it has followed the commands, which tell a steering better than a yaw rate does */
}@  }
  slipwise_cover(walk, start, window->end, 1);
  return SLIPWISE_OK;
}

/* What a pass says. */
static inline void slipwise_results(const slipwise_walk *walk, slipwise_pose *pose, slipwise_drive *drive) {
  *pose = walk->path.pose;
  if (drive) {
    drive->v = walk->speed.fast + walk->speed.slow;
@SIDE{    drive->vy = walk->side.fast + walk->side.slow;
}@    drive->omega = walk->yaw_rate.fast + walk->yaw_rate.slow;
@STEER{    drive->omega *= drive->v;
}@  }
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

@COVARIANCE@
#endif /* SLIPWISE_MODEL_H */
