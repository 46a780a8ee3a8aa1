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

static inline slipwise_cursor slipwise_cursor_at(const slipwise_commands *commands, const slipwise_start *at,
                                                 slipwise_real delay, slipwise_real start, slipwise_real known_until) {
  slipwise_cursor cursor;
  (void)at;
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
  slipwise_drive held = {0,@SIDE{ 0,}@ 0}; /* at rest before the first command */
  if (cursor->next > 0) {
    const slipwise_command *command = slipwise_command_at(cursor->commands, cursor->next - 1);
    held.v = command->v;
@SIDE{    held.vy = command->vy;
}@    held.omega = command->omega;
  }
  return held;
}

/* Whether some command acts already. */
static inline int slipwise_acts(const slipwise_cursor *cursor) { return cursor->next > 0; }

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
