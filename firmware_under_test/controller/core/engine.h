/* SPDX-License-Identifier: Apache-2.0 */
/* Step engine: the work of the timer interrupt at each tick, and the hand-over of the next period to it.
 *
 * A tick: the interrupt first writes out the result of the tick before (PUL up; X and Y in one store), then
 * kb_tick_compute() computes the next, then lowers PUL, then writes DIR. So PUL is high for the length of the
 * computation, and a DIR that changes with a new period does so after the last PUL of the old one and most of
 * a tick before the first PUL of the new one.
 *
 * An axis with m steps in a period of n ticks adds m 256 / n to an 8-bit accumulator each tick and steps when
 * it overflows: n ticks add 256 m, so the count is exact and the accumulator ends where it began. */
#ifndef KERFBENCH_CONTROLLER_ENGINE_H
#define KERFBENCH_CONTROLLER_ENGINE_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware_under_test/controller/protocol.h"

/* Where pointers do not know the space that they point into, those of the tick's interrupt are told. */
#ifdef __SDCC
#define KB_IN_XDATA __xdata
#else
#define KB_IN_XDATA
#endif

enum {
  KB_FEED_PUL = 0x01,
  KB_FEED_DIR = 0x02,
  KB_LASER_GATE = 0x04,
  KB_LASER_PWM = 0x08,
  KB_ACC_START = 128, /* The first step of m comes after half of its spacing. */
  KB_INC_PER_STEP = 256U / KB_TICKS_PER_PERIOD,
  KB_PUL_A = 0x55,    /* bits of port A */
  KB_HELD_FEED = 0x02 /* the feed's PUL among those of port A, where all are in one byte */
};

/* Levels of the inputs, as kb_hal_inputs() gives them: the bits of port L. */
enum { KB_IN_LIMIT_X = 0x01, KB_IN_LIMIT_Y = 0x02, KB_IN_LIMITS = 0x03, KB_IN_INTERLOCK = 0x04 };

struct kb_period {
  uint8_t inc[KB_AXES]; /* KB_INC_PER_STEP * steps */
  uint8_t idle_a;       /* levels of port A between pulses: DIR and PUL */
  uint8_t idle_c;
  bool laser_changes;
  kb_ticks_t laser_delay; /* delay in ticks from the start of the period */
  uint8_t gate;           /* 0 or KB_LASER_GATE */
  uint8_t power;
};

struct kb_laser_event {
  kb_ticks_t due;
  uint8_t gate;
  uint8_t power;
};

struct kb_engine {
  /* Levels that the next tick writes first; then PUL falls except for what `held` was until then, and DIR is
   * that of `idle`. */
  uint8_t out_a;
  uint8_t out_c;
  uint8_t idle_a; /* levels of PUL and DIR between pulses, in this period */
  uint8_t idle_c;
  /* Configuration. */
  uint8_t wide;       /* mask of the axes whose PUL stays active for wide_ticks; bits as in `held` */
  uint8_t wide_ticks; /* width in ticks, 1 … KB_WIDE_TICKS_MAX */
  uint8_t held;       /* active pulses: PUL of port A, and KB_HELD_FEED */
  uint8_t ends[KB_WIDE_TICKS_MAX + 1]; /* bits of `held` that each of the coming ticks clears */
  uint8_t ticks_left;                  /* ticks left in the period, including the next tick to be computed */
  kb_ticks_t tick;                     /* number of the tick, modulo its range */
  uint8_t gate;
  uint8_t power;
  uint8_t sigma;
#if KB_PWM_TICKS > 1
  uint8_t pwm; /* 0 or KB_LASER_PWM */
  uint8_t pwm_left;
#endif
  uint8_t laser_first;
  uint8_t laser_end;
  uint8_t acc[KB_AXES];
  uint8_t inc[KB_AXES];
  /* Fields shared by interrupt and main loop. */
  bool next_ready;
  bool demand; /* a period must be ready at each boundary */
  bool late;   /* a demanded period was not ready */
  uint8_t boundaries;
  uint16_t boundary_time; /* time in units of kb_hal_now() */
  struct kb_period next;
  struct kb_laser_event laser[KB_LASER_EVENTS];
};

extern volatile struct kb_engine kb_engine;

void kb_engine_init(void);
/* Sets the levels between pulses, and the pulses that stay active. Only while nothing moves. */
void kb_engine_configure(uint8_t idle_a, uint8_t idle_c, uint8_t wide, uint8_t wide_ticks);
/* Offers the next period. Main loop only, when !next_ready. */
void kb_engine_offer(const struct kb_period* period);
/* Turns the laser off and removes all laser events, delayed or offered; takes effect in the present tick or
 * the next. */
void kb_engine_laser_off(void);
/* Stops the axes, turns the laser off and drops the offered period. Returns the ticks of the current period
 * that were really output. */
uint8_t kb_engine_halt(bool* next_dropped);

/* Counts the tick that is to be computed; true where it is the first of a period. */
static inline bool kb_tick_begins_period(void) {
  const uint8_t left = kb_engine.ticks_left;
  if (left == 0) {
    return true;
  }
  kb_engine.ticks_left = (uint8_t)(left - 1U);
  return false;
}

/* Boundary of a period: called by the interrupt where kb_tick_begins_period(). */
static inline void kb_tick_boundary(uint16_t now) {
  volatile KB_IN_XDATA struct kb_engine* const e = &kb_engine;
  e->ticks_left = KB_TICKS_PER_PERIOD - 1U;
  e->boundaries++;
  e->boundary_time = now;
  if (e->next_ready) {
    e->inc[0] = e->next.inc[0];
    e->inc[1] = e->next.inc[1];
    e->inc[2] = e->next.inc[2];
    e->inc[3] = e->next.inc[3];
    e->inc[4] = e->next.inc[4];
    e->idle_a = e->next.idle_a;
    e->idle_c = e->next.idle_c;
    if (e->next.laser_changes) {
      const uint8_t end = e->laser_end;
      volatile KB_IN_XDATA struct kb_laser_event* const event = &e->laser[end];
      event->due = (kb_ticks_t)(e->tick + e->next.laser_delay);
      event->gate = e->next.gate;
      event->power = e->next.power;
      e->laser_end = (uint8_t)((end + 1U) & (KB_LASER_EVENTS - 1U));
    }
    e->next_ready = false;
  } else {
    e->inc[0] = 0;
    e->inc[1] = 0;
    e->inc[2] = 0;
    e->inc[3] = 0;
    e->inc[4] = 0;
    if (e->demand) {
      e->late = true;
      e->gate = 0;
      e->power = 0;
      e->laser_first = e->laser_end;
    }
  }
}

/* Levels after a tick, from `held` and `out_c` as they were before it computed the next. */
static inline uint8_t kb_level_a(uint8_t held) { return (uint8_t)((held & KB_PUL_A) ^ kb_engine.idle_a); }
static inline uint8_t kb_level_c(uint8_t held, uint8_t out_c) {
  const uint8_t laser = out_c & (uint8_t) ~(KB_FEED_PUL | KB_FEED_DIR);
  uint8_t axis = kb_engine.idle_c;
  if (held & KB_HELD_FEED) {
    axis ^= KB_FEED_PUL;
  }
  return laser | axis;
}

/* One bit of the laser's PWM. */
static inline uint8_t kb_tick_pwm(void) {
  volatile KB_IN_XDATA struct kb_engine* const e = &kb_engine;
  const uint8_t power = e->power;
  uint8_t sigma = (uint8_t)(e->sigma + power); /* modulo 255 */
  uint8_t bit = 0;
  if (sigma < power || sigma == 255U) {
    sigma = (uint8_t)(sigma + 1U);
    bit = KB_LASER_PWM;
  }
  e->sigma = sigma;
  return bit;
}

/* Updates the pulses that stay active: ends those whose time is over, begins new ones. Returns all of
 * them. */
static inline uint8_t kb_tick_hold(uint8_t tick, uint8_t pulses) {
  volatile KB_IN_XDATA struct kb_engine* const e = &kb_engine;
  uint8_t held = e->held;
  const uint8_t begun = pulses & e->wide;
  if ((held | begun) == 0) {
    return 0;
  }
  const uint8_t slot = tick & KB_WIDE_TICKS_MAX;
  const uint8_t ended = e->ends[slot];
  if (ended != 0) {
    e->ends[slot] = 0;
    held &= (uint8_t)~ended;
  }
  if (begun != 0) {
    e->ends[(uint8_t)(tick + e->wide_ticks) & KB_WIDE_TICKS_MAX] = begun;
    held |= begun;
  }
  e->held = held;
  return held;
}

/* Computes the levels of the next tick. `holds`: there may be pulses that stay active. The argument is a
 * constant, for a target whose ticks have no time to test it. */
static inline void kb_tick_compute(uint8_t inputs, bool holds) {
  volatile KB_IN_XDATA struct kb_engine* const e = &kb_engine;
  uint8_t pulses = 0;
  uint8_t inc;
  uint8_t acc;

#define KB_DDA(axis, bit)               \
  inc = e->inc[axis];                   \
  acc = (uint8_t)(e->acc[axis] + inc);  \
  e->acc[axis] = acc;                   \
  if (acc < inc) {                      \
    pulses = (uint8_t)(pulses | (bit)); \
  }
  KB_DDA(KB_GALVO_X, 0x01)
  KB_DDA(KB_GALVO_Y, 0x04)
  KB_DDA(KB_GANTRY_X, 0x10)
  KB_DDA(KB_GANTRY_Y, 0x40)
  KB_DDA(KB_FEED, KB_HELD_FEED)
#undef KB_DDA
  const kb_ticks_t tick = e->tick;
  e->tick = (kb_ticks_t)(tick + 1U);
  if (holds) {
    pulses |= kb_tick_hold((uint8_t)tick, pulses);
  }
  e->out_a = (uint8_t)((pulses & KB_PUL_A) ^ e->idle_a);

  uint8_t laser = 0;
  const uint8_t first = e->laser_first;
  if (first != e->laser_end && e->laser[first].due == tick) {
    e->gate = e->laser[first].gate;
    e->power = e->laser[first].power;
    e->laser_first = (uint8_t)((first + 1U) & (KB_LASER_EVENTS - 1U));
#if KB_PWM_TICKS > 1
    if (e->power == 0 || !(e->out_c & KB_LASER_GATE)) { /* the PWM starts with the gate and stops at once */
      e->pwm_left = 0;
    }
#endif
  }
#ifdef KB_DEFECT_INTERLOCK_IGNORED
  inputs |= KB_IN_INTERLOCK;
#endif
  /* The main loop may be a whole period away: guard and limits act here. */
  if ((inputs & (KB_IN_INTERLOCK | KB_IN_LIMITS)) == KB_IN_INTERLOCK) {
#if KB_PWM_TICKS > 1
    if (e->pwm_left == 0) {
      e->pwm = kb_tick_pwm();
      e->pwm_left = KB_PWM_TICKS;
    }
    e->pwm_left--;
    laser |= e->pwm;
#else
    laser = kb_tick_pwm();
#endif
    laser = (uint8_t)(laser | e->gate);
  }
  uint8_t out_c = (uint8_t)(e->idle_c | laser);
  if (pulses & KB_HELD_FEED) {
    out_c ^= KB_FEED_PUL;
  }
  e->out_c = out_c;
}

#endif
