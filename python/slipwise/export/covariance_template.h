/* The parameters' covariance is the product of these rows' transpose and themselves. */
#define SLIPWISE_ROOTS @ROOT_COUNT@
static const slipwise_real slipwise_roots[SLIPWISE_SLOTS(SLIPWISE_ROOTS)]
                                         [SLIPWISE_SLOTS(SLIPWISE_PARAMETER_COUNT)] = {
@ROOTS@
};
/* Slip parameters that a disturbance moves about what was learned: which, and the variance that a process of each time
 * constant [s] gives them. Their mean over a prediction has another normal deviate each. */
#define SLIPWISE_DISTURBED @DISTURBED_COUNT@
#define SLIPWISE_DISTURBANCE_TIMES @TIME_COUNT@
static const int slipwise_disturbed[SLIPWISE_SLOTS(SLIPWISE_DISTURBED)] = {@DISTURBED@};
static const slipwise_real slipwise_disturbance_times[SLIPWISE_SLOTS(SLIPWISE_DISTURBANCE_TIMES)] = {@TIMES@};
static const slipwise_real slipwise_disturbance_variance[SLIPWISE_SLOTS(SLIPWISE_DISTURBED)]
                                                   [SLIPWISE_SLOTS(SLIPWISE_DISTURBANCE_TIMES)] = {
@VARIANCES@
};
/* What held-out predictions of these horizons [s] needed: ln of the inflation of the covariance, and of the degrees of
 * freedom of the Student t that has it. */
#define SLIPWISE_TAILS @TAIL_COUNT@
static const slipwise_real slipwise_tails[SLIPWISE_TAILS][3] = {@TAILS@};

/* Growth of the covariance, and degrees of freedom, at a horizon [s]: between those judged by their logarithms. */
static inline void slipwise_tail(slipwise_real horizon, slipwise_real *inflation, slipwise_real *dof) {
  const slipwise_real(*at)[3] = slipwise_tails;
  slipwise_real fraction = 0;
  int i = 0;
  while (i + 2 < SLIPWISE_TAILS && horizon > at[i + 1][0]) {
    ++i;
  }
  if (SLIPWISE_TAILS > 1) {
    fraction = (horizon - at[i][0]) / (at[i + 1][0] - at[i][0]);
    fraction = fraction < 0 ? SLIPWISE_R(0) : fraction > 1 ? SLIPWISE_R(1) : fraction;
    *inflation = SLIPWISE_MATH(exp)(at[i][1] + fraction * (at[i + 1][1] - at[i][1]));
    *dof = SLIPWISE_MATH(exp)(at[i][2] + fraction * (at[i + 1][2] - at[i][2]));
  } else {
    *inflation = SLIPWISE_MATH(exp)(at[0][1]);
    *dof = SLIPWISE_MATH(exp)(at[0][2]);
  }
}

/* Standard deviation of the mean of such a parameter over a prediction of this horizon [s]. */
static inline slipwise_real slipwise_disturbance_std(int place, slipwise_real horizon) {
  slipwise_real variance = 0;
  int i;
  for (i = 0; i < SLIPWISE_DISTURBANCE_TIMES; ++i) {
    const slipwise_real s = horizon / slipwise_disturbance_times[i];
    const slipwise_real mean = s < SLIPWISE_SMALL_SPAN ? 1 - s / 3 * (1 - s / 4 * (1 - s / 5))
                                                       : 2 / s * (1 + SLIPWISE_MATH(expm1)(-s) / s);
    variance += mean * slipwise_disturbance_variance[place][i];
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

/* As slipwise_predict, with the covariance of (x, y, yaw) that slipwise.predict states: learned parameters, the slip
 * disturbance about them, slip noise, the noise of two measured poses, and inflation. It costs 2 * (SLIPWISE_ROOTS +
 * SLIPWISE_DISTURBED) + 1 predictions. */
static inline int slipwise_predict_covariance(const slipwise_commands *commands, const slipwise_window *window,
                                              slipwise_pose *pose, slipwise_drive *drive,
                                              slipwise_real covariance[3][3]) {
  const slipwise_model model = slipwise_model_shifted(0);
  slipwise_real parameters[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, noise_sum[3][3];
  slipwise_real by[SLIPWISE_SLOTS(SLIPWISE_PARAMETER_COUNT)], inflation, dof;
  slipwise_noise noise = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  slipwise_walk walk;
  int root, i, j, side;
  const int status = slipwise_run(&model, commands, window, &noise, &walk);
  if (status != SLIPWISE_OK) {
    return status;
  }
  for (root = 0; root < SLIPWISE_ROOTS + SLIPWISE_DISTURBED; ++root) { /* derivatives along the roots: central differences */
    slipwise_real change[3] = {0, 0, 0};
    for (side = -1; side <= 1; side += 2) {
      slipwise_walk shifted;
      slipwise_model other;
      for (i = 0; i < SLIPWISE_PARAMETER_COUNT; ++i) {
        by[i] = root < SLIPWISE_ROOTS ? (slipwise_real)side * SLIPWISE_DIFFERENCE * slipwise_roots[root][i] : 0;
      }
      if (root >= SLIPWISE_ROOTS) {
        const int place = root - SLIPWISE_ROOTS;
        by[slipwise_disturbed[place]] = (slipwise_real)side * SLIPWISE_DIFFERENCE *
                                        slipwise_disturbance_std(place, window->end - window->start);
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
  slipwise_tail(window->end - window->start, &inflation, &dof);
  for (i = 0; i < 3; ++i) {
    for (j = 0; j < 3; ++j) {
      covariance[i][j] =
          inflation * (parameters[i][j] + slipwise_noise_root[i] * slipwise_noise_root[j] * noise_sum[i][j]);
    }
  }
  slipwise_results(&walk, pose, drive);
  return SLIPWISE_OK;
}
