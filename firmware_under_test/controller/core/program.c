/* SPDX-License-Identifier: Apache-2.0 */
#include "program.h"

#include <string.h>

#include "belt.h"
#include "engine.h"
#include "power_loop.h"
#include "queue.h"

enum {
  KB_AXIS_MASK = 0x1F,
  KB_DRY_TICKS = 8 /* bytes may still come while more than this is left of the period */
};

enum phase { KB_PHASE_RUN, KB_PHASE_STAND, KB_PHASE_MARK, KB_PHASE_RAMP, KB_PHASE_TAIL };

static struct {
  struct kb_config config;
  bool configured;
  bool careful; /* true if an axis may not turn at full speed */
  enum phase phase;
  enum kb_fault ramp_fault;
  uint16_t periods_left; /* periods left of STAND and TAIL */
  int8_t steps[KB_AXES]; /* steps of the last period offered, correction included; RAMP slows them down */
  int8_t previous_steps[KB_AXES];
  int32_t position[KB_AXES];
  bool outside; /* true if outside of the field at the end of the last period offered */
  /* least distance of any axis from the edge of the field when last computed, less the steps since */
  uint16_t room;
  int16_t owed[KB_AXES]; /* steps that a reversal has delayed */
  uint8_t dir_a;         /* logical levels of DIR on port A; high: positive */
  uint8_t dir_c;
  uint8_t gate;
  uint8_t power;
  /* State of following. */
  uint8_t follow; /* number of the following axis + 1, or 0 */
  int16_t gain;
  int16_t correction[KB_AXES];
  bool lags;
  int32_t reference; /* belt position at n = 0, 1/256 count */
  uint32_t nominal;  /* n at the end of the period, 1/256 count, modulo 2^32 */
  uint8_t nominal_part;
  int32_t mark_offset;
} p;

void kb_program_init(void) {
  memset(&p, 0, sizeof(p));
  kb_queue_clear();
}

static const uint8_t dir_bits[KB_AXES] = {0x02, 0x08, 0x20, 0x80, KB_FEED_DIR};

/* Bit of an axis's PUL among those that the engine holds. */
static uint8_t heldBits(uint8_t axes) {
  uint8_t bits = (axes & (uint8_t)(1U << KB_FEED)) ? KB_HELD_FEED : 0;
  for (uint8_t axis = 0; axis < KB_FEED; ++axis) {
    if (axes & (uint8_t)(1U << axis)) {
      bits = (uint8_t)(bits | dir_bits[axis] >> 1);
    }
  }
  return bits;
}

void kb_program_configure(const struct kb_config* config) {
  p.config = *config;
#ifdef KB_DEFECT_GATE_LATE
  /* Defect: the laser's own delay of 2 ms is added where it should be taken off. */
  enum { LATE_TICKS = KB_CPU_HZ / 500UL / KB_TICK_CYCLES, MOST_TICKS = 255 };
  p.config.gate_on_delay =
      (uint16_t)(config->gate_on_delay > MOST_TICKS - LATE_TICKS ? MOST_TICKS
                                                                 : config->gate_on_delay + LATE_TICKS);
  p.config.gate_off_delay =
      (uint16_t)(config->gate_off_delay > MOST_TICKS - LATE_TICKS ? MOST_TICKS
                                                                  : config->gate_off_delay + LATE_TICKS);
#endif
  kb_engine_configure(p.dir_a ^ config->invert_a, p.dir_c ^ config->invert_c, heldBits(config->wide),
                      config->wide_ticks);
  p.careful = memcmp(config->turn_steps, config->most_steps, sizeof(config->turn_steps)) != 0;
  p.configured = true;
}

bool kb_program_configured(void) { return p.configured; }

/* Whether some axis ends the period beyond the field. Steps of a period all go in one direction, so between
 * two ends within it no axis is beyond. Far from the edges nothing needs to be computed: no axis makes more
 * steps than that. */
static bool endsOutside(void) {
  if (p.room >= (uint8_t)KB_MAX_STEPS_PER_PERIOD) {
    p.room = (uint16_t)(p.room - (uint8_t)KB_MAX_STEPS_PER_PERIOD);
    return false;
  }
  uint16_t room = UINT16_MAX;
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    const int32_t end = p.position[axis] + p.steps[axis];
    const int32_t low = p.config.lowest[axis];
    const int32_t high = p.config.highest[axis];
    if (end < low || end > high) {
      p.room = 0;
      return true;
    }
    const uint32_t below = (uint32_t)end - (uint32_t)low;
    const uint32_t above = (uint32_t)high - (uint32_t)end;
    const uint32_t least = below < above ? below : above;
    room = least < room ? (uint16_t)least : room;
  }
  p.room = room;
  return false;
}

void kb_program_start(void) {
  p.configured = false;
  p.phase = KB_PHASE_RUN;
  p.ramp_fault = KB_OK;
  p.lags = false;
  p.follow = 0;
  p.gain = 0;
  p.gate = 0;
  p.power = 0;
  memset(p.steps, 0, sizeof(p.steps));
  memset(p.correction, 0, sizeof(p.correction));
  memset(p.owed, 0, sizeof(p.owed));
  p.nominal = 0;
  p.nominal_part = 0;
  p.room = 0;
  p.outside = endsOutside();
  kb_belt_clear_marks();
  p.reference = kb_belt_ahead(1);
}

void kb_program_ramp(enum kb_fault fault) {
  if (p.phase == KB_PHASE_RAMP) {
    return;
  }
  p.phase = KB_PHASE_RAMP;
  p.ramp_fault = fault;
  memset(p.owed, 0, sizeof(p.owed));
  kb_engine_laser_off();
}

enum kb_fault kb_program_ramping(void) { return p.phase == KB_PHASE_RAMP ? p.ramp_fault : KB_OK; }

bool kb_program_follows(void) {
  return p.follow != 0 && (p.phase == KB_PHASE_RUN || p.phase == KB_PHASE_STAND);
}

bool kb_program_lags(void) { return kb_program_follows() && p.lags && p.gate != 0; }
const struct kb_config* kb_program_config(void) { return &p.config; }

int32_t kb_program_position(uint8_t axis) { return p.position[axis]; }

/* Length of the operation at the head of the queue, or 0 where it is incomplete or unknown. */
static uint8_t wholeOp(bool* unknown) {
  *unknown = false;
  if (kb_queue_empty()) {
    return 0;
  }
  const uint8_t op = kb_queue_peek(0);
  uint8_t length = 1;
  if (op & KB_OP_MOVE) {
    for (uint8_t mask = op & KB_AXIS_MASK; mask != 0; mask >>= 1) {
      length = (uint8_t)(length + (mask & 1U));
    }
    length = (uint8_t)(length + ((op & KB_OP_POWER) ? 1 : 0) + ((op & KB_OP_GAIN) ? 2 : 0));
  } else if (op == KB_OP_WAIT_MARK) {
    length = 5;
  } else if (op == KB_OP_WAIT) {
    length = 3;
  } else if (op == KB_OP_FOLLOW) {
    length = 2;
  } else if (op != KB_OP_END) {
    *unknown = true;
    return 0;
  }
  return kb_queue_used() >= length ? length : 0;
}

static enum kb_fault takeMove(uint8_t op, bool* lit, uint8_t* power) {
  uint8_t at = 1;
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    if (op & (uint8_t)(1U << axis)) {
      const int16_t count = (int8_t)kb_queue_peek(at++);
      if (count > p.config.most_steps[axis] || count < -(int16_t)p.config.most_steps[axis]) {
        return KB_FAULT_OVERSPEED;
      }
      p.steps[axis] = (int8_t)count;
    }
  }
  if (op & KB_OP_POWER) {
    *lit = true;
    *power = kb_queue_peek(at++);
  }
  if (op & KB_OP_GAIN) {
    p.gain = (int16_t)(uint16_t)(kb_queue_peek(at) | (uint16_t)kb_queue_peek((uint8_t)(at + 1U)) << 8);
  }
  return KB_OK;
}

/* Wanted correction, round((b - n) * gain / 4096), at the end of the period in preparation, which follows the
 * present one. */
static int16_t wantedCorrection(void) {
  const int32_t belt = (int32_t)((uint32_t)kb_belt_ahead(2) - (uint32_t)p.reference);
  const int32_t ahead = (int32_t)((uint32_t)belt - p.nominal);
  int32_t whole = ahead >> 8;
  if (whole > INT16_MAX) {
    whole = INT16_MAX;
  } else if (whole < INT16_MIN) {
    whole = INT16_MIN;
  }
  const int16_t part = (int16_t)(ahead & 0xFF);
  const int32_t scaled = (int32_t)(int16_t)whole * p.gain + (((int32_t)part * p.gain) >> 8);
  const int32_t steps = (scaled + 2048) >> 12;
  return steps > INT16_MAX / 2 ? INT16_MAX / 2 : steps < INT16_MIN / 2 ? INT16_MIN / 2 : (int16_t)steps;
}

static int16_t within(int16_t value, uint8_t most) {
  return value > most ? most : value < -(int16_t)most ? (int16_t) - (int16_t)most : value;
}

/* Keeps DIR's set-up and hold: few steps, and therefore late ones, next to a change of DIR. */
static void turnWithCare(void) {
  if (!p.careful) {
    return;
  }
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    if (p.steps[axis] == 0 && p.owed[axis] == 0) {
      continue;
    }
    const uint8_t turn = p.config.turn_steps[axis];
    const uint8_t most = p.config.most_steps[axis];
    const int16_t wanted = (int16_t)(p.steps[axis] + p.owed[axis]);
    const int8_t before = p.previous_steps[axis];
    const bool forwards = ((axis == KB_FEED ? p.dir_c : p.dir_a) & dir_bits[axis]) != 0;
    const bool turns = wanted != 0 && (wanted > 0) != forwards;
    uint8_t limit = turns ? turn : most;
    if (turns && (before > (int16_t)turn || before < -(int16_t)turn)) {
      limit = 0;
    }
    p.steps[axis] = (int8_t)within(wanted, limit);
    p.owed[axis] = (int16_t)(wanted - p.steps[axis]);
  }
}

/* Adds the change of the corrections to the steps. True until all corrections have reached their goal. */
static bool correct(bool referenced) {
  bool pending = false;
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    const bool followed = referenced && p.follow == axis + 1U;
    if (!followed && p.correction[axis] == 0) {
      continue;
    }
    const int16_t target = followed ? wantedCorrection() : 0;
    const int16_t total =
        within((int16_t)(p.steps[axis] + target - p.correction[axis]), p.config.most_steps[axis]);
    p.correction[axis] = (int16_t)(p.correction[axis] + total - p.steps[axis]);
    p.steps[axis] = (int8_t)total;
    pending = pending || p.correction[axis] != target;
    if (followed) {
      const int16_t missing = (int16_t)(target - p.correction[axis]);
      p.lags = within(missing, p.config.most_steps[axis]) != missing;
    }
  }
  return pending;
}

static void offer(bool lit, uint8_t power) {
  struct kb_period period;
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    const int8_t steps = p.steps[axis];
    period.inc[axis] = (uint8_t)((uint8_t)(steps < 0 ? -steps : steps) * KB_INC_PER_STEP);
    p.position[axis] += steps;
    if (steps != 0) {
      uint8_t* const dir = axis == KB_FEED ? &p.dir_c : &p.dir_a;
      const uint8_t bit = dir_bits[axis];
      *dir = steps > 0 ? (uint8_t)(*dir | bit) : (uint8_t)(*dir & (uint8_t)~bit);
    }
  }
  period.idle_a = p.dir_a ^ p.config.invert_a;
  period.idle_c = p.dir_c ^ p.config.invert_c;
  const uint8_t gate = lit ? KB_LASER_GATE : 0;
  power = kb_power_command(lit, power);
  period.laser_changes = gate != p.gate || power != p.power;
  period.laser_delay = (kb_ticks_t)(lit ? p.config.gate_on_delay : p.config.gate_off_delay);
  period.gate = p.gate = gate;
  period.power = p.power = power;
  kb_engine_offer(&period);
}

static bool rampDown(void) {
  bool moving = false;
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    p.steps[axis] = (int8_t)(p.previous_steps[axis] / 2);
    moving = moving || p.previous_steps[axis] != 0; /* the last step comes out before the halt */
  }
  return moving;
}

/* Interprets the operations up to the next that takes time. KB_STEP_ON with *ready false: bytes are
 * missing. */
static enum kb_step interpret(bool* ready, bool* lit, uint8_t* power, enum kb_fault* fault) {
  *ready = true;
  for (;;) {
    bool unknown;
    const uint8_t length = wholeOp(&unknown);
    if (unknown) {
      *fault = KB_FAULT_PROGRAM;
      return KB_STEP_FAULT;
    }
    if (length == 0) {
      *ready = false;
      return KB_STEP_ON;
    }
    const uint8_t op = kb_queue_peek(0);
    if (op & KB_OP_MOVE) {
      *fault = takeMove(op, lit, power);
      kb_queue_drop(length);
      return *fault == KB_OK ? KB_STEP_ON : KB_STEP_FAULT;
    }
    if (op == KB_OP_END) {
      p.phase = KB_PHASE_TAIL;
      /* The tail lasts until the last delayed laser event is out and the last period has run. */
      const uint16_t delay =
          p.config.gate_off_delay > p.config.gate_on_delay ? p.config.gate_off_delay : p.config.gate_on_delay;
      p.periods_left = (uint16_t)(delay / KB_TICKS_PER_PERIOD + 2U);
      kb_queue_drop(length);
      return KB_STEP_ON;
    }
    if (op == KB_OP_WAIT) {
      p.periods_left = (uint16_t)(kb_queue_peek(1) | (uint16_t)kb_queue_peek(2) << 8);
      if (p.periods_left != 0) {
        p.phase = KB_PHASE_STAND;
        kb_queue_drop(length);
        return KB_STEP_ON;
      }
    } else if (op == KB_OP_FOLLOW) {
      if (kb_queue_peek(1) > KB_AXES) {
        *fault = KB_FAULT_PROGRAM;
        return KB_STEP_FAULT;
      }
      p.follow = kb_queue_peek(1);
    } else {
      p.mark_offset = (int32_t)((uint32_t)kb_queue_peek(1) | (uint32_t)kb_queue_peek(2) << 8 |
                                (uint32_t)kb_queue_peek(3) << 16 | (uint32_t)kb_queue_peek(4) << 24);
      p.phase = KB_PHASE_MARK;
      kb_queue_drop(length);
      return KB_STEP_ON;
    }
    kb_queue_drop(length);
  }
}

/* True if the mark has come and the belt will be far enough beyond it at the start of the period in
 * preparation. */
static bool markReached(void) {
  int32_t mark;
  if (!kb_belt_mark(&mark)) {
    return false;
  }
  const int32_t beyond = (int32_t)((uint32_t)kb_belt_ahead(1) - (uint32_t)mark);
  if ((int32_t)((uint32_t)beyond - (uint32_t)p.mark_offset * 256U) < 0) {
    return false;
  }
  p.reference = mark;
  p.nominal = (uint32_t)p.mark_offset * 256U;
  p.nominal_part = 0;
  kb_belt_drop_mark();
  return true;
}

static bool owes(void) {
  bool any = false;
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    any = any || p.owed[axis] != 0;
  }
  return any;
}

static void advanceNominal(void) {
  const uint16_t part = (uint16_t)(p.nominal_part + (p.config.nominal_per_period & 0xFFU));
  p.nominal_part = (uint8_t)part;
  p.nominal += (p.config.nominal_per_period >> 8) + (part >> 8);
}

enum kb_step kb_program_step(enum kb_fault* fault) {
  memcpy(p.previous_steps, p.steps, sizeof(p.steps));
  memset(p.steps, 0, sizeof(p.steps));
  bool lit = false;
  uint8_t power = p.config.idle_power;

  if (p.phase == KB_PHASE_MARK && markReached()) {
    p.phase = KB_PHASE_RUN;
  }
  if (p.phase == KB_PHASE_RUN) {
    bool ready;
    if (interpret(&ready, &lit, &power, fault) == KB_STEP_FAULT) {
      memcpy(p.steps, p.previous_steps, sizeof(p.steps));
      return KB_STEP_FAULT;
    }
    if (p.phase == KB_PHASE_MARK && markReached()) { /* the operation waited already: no period is lost */
      p.phase = KB_PHASE_RUN;
      memcpy(p.steps, p.previous_steps, sizeof(p.steps));
      return KB_STEP_ON;
    }
    if (!ready) {
      if (kb_engine.ticks_left > KB_DRY_TICKS) {
        memcpy(p.steps, p.previous_steps, sizeof(p.steps));
        return KB_STEP_ON;
      }
      kb_program_ramp(KB_FAULT_DRY);
    }
  }
  bool pending;
  switch (p.phase) {
    case KB_PHASE_RUN:
      advanceNominal();
      correct(true);
      break;
    case KB_PHASE_STAND:
      if (--p.periods_left == 0) {
        p.phase = KB_PHASE_RUN;
      }
      advanceNominal();
      correct(true);
      break;
    case KB_PHASE_MARK:
      correct(false);
      break;
    case KB_PHASE_RAMP:
      power = 0;
      if (!rampDown()) {
        memcpy(p.steps, p.previous_steps, sizeof(p.steps));
        *fault = p.ramp_fault;
        return KB_STEP_FAULT;
      }
      break;
    case KB_PHASE_TAIL:
      power = 0;
      pending = correct(false) || owes();
      if (!pending && p.periods_left-- == 0) {
        return KB_STEP_DONE;
      }
      break;
  }
  turnWithCare();
  /* A dark axis may leave the field: it overshoots on its return, or catches up. */
  const bool before = p.outside;
  p.outside = endsOutside();
  if (lit && (before || p.outside)) {
    kb_program_ramp(KB_FAULT_FIELD);
    rampDown();
    lit = false;
    power = 0;
  }
  offer(lit, power);
  return KB_STEP_ON;
}

void kb_program_halt(void) {
  /* The positions are corrected for the steps of the present period that were not output, and for all steps
   * of the offered one. */
  bool dropped;
  const uint8_t done_ticks = kb_engine_halt(&dropped);
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    const int8_t current = dropped ? p.previous_steps[axis] : p.steps[axis];
    const uint8_t count = (uint8_t)(current < 0 ? -current : current);
    const uint8_t done = (uint8_t)((KB_ACC_START + (uint16_t)(KB_INC_PER_STEP * count) * done_ticks) >> 8);
    const int8_t lost = (int8_t)(count - done);
    p.position[axis] -= current < 0 ? -lost : lost;
    if (dropped) {
      p.position[axis] -= p.steps[axis];
    }
  }
  memset(p.steps, 0, sizeof(p.steps));
  memset(p.previous_steps, 0, sizeof(p.previous_steps));
  memset(p.owed, 0, sizeof(p.owed));
  p.gate = 0;
  p.power = 0;
  p.phase = KB_PHASE_RUN;
  kb_queue_clear();
}
