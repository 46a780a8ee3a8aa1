/* Slip noise: power spectral densities [unit^2/s of the rate] and [unit^2 per motion], and the fraction of the motion that
 * stays the same all along, of (forward, left, turn). */
static const slipwise_real slipwise_noise_time[3] = {@NOISE_TIME@};
static const slipwise_real slipwise_noise_motion[3] = {@NOISE_MOTION@};
static const slipwise_real slipwise_noise_share[3] = {@NOISE_FRACTION@};
@NOISE_SCALARS@

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
  const slipwise_real distance = @DISTANCE@ * duration;
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
