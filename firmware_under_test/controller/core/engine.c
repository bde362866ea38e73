/* SPDX-License-Identifier: Apache-2.0 */
#include "engine.h"

#include <string.h>

#include "hal.h"

volatile struct kb_engine kb_engine;

void kb_engine_init(void) {
  const uint8_t saved = kb_hal_lock();
  memset((void*)&kb_engine, 0, sizeof(kb_engine));
  kb_engine.ticks_left = KB_TICKS_PER_PERIOD;
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    kb_engine.acc[axis] = KB_ACC_START;
  }
  kb_hal_unlock(saved);
}

/* Sets the levels of the next tick without new pulses. */
static void rest(void) {
  const uint8_t held = kb_engine.held;
  kb_engine.out_a = kb_level_a(held);
  kb_engine.out_c = kb_level_c(held, 0);
}

void kb_engine_configure(uint8_t idle_a, uint8_t idle_c, uint8_t wide, uint8_t wide_ticks) {
  const uint8_t saved = kb_hal_lock();
  kb_engine.idle_a = idle_a;
  kb_engine.idle_c = idle_c;
  kb_engine.wide = wide;
  kb_engine.wide_ticks = wide_ticks;
  kb_engine.held = 0;
  memset((void*)kb_engine.ends, 0, sizeof(kb_engine.ends));
  rest();
  kb_hal_hold_pulses(wide != 0);
  kb_hal_unlock(saved);
}

void kb_engine_offer(const struct kb_period* period) {
  /* The interrupt does not look at `next` before next_ready; a byte is stored at once. */
  kb_engine.next = *period;
  kb_hal_barrier();
  kb_engine.next_ready = true;
}

static void laserOff(void) {
  kb_engine.gate = 0;
  kb_engine.power = 0;
  kb_engine.sigma = 0;
#if KB_PWM_TICKS > 1
  kb_engine.pwm_left = 0;
#endif
  kb_engine.laser_first = kb_engine.laser_end;
  kb_engine.next.laser_changes = false;
  kb_engine.out_c &= KB_FEED_PUL | KB_FEED_DIR;
}

void kb_engine_laser_off(void) {
  const uint8_t saved = kb_hal_lock();
  laserOff();
  kb_hal_unlock(saved);
}

uint8_t kb_engine_halt(bool* next_dropped) {
  const uint8_t saved = kb_hal_lock();
  laserOff();
  /* The step bits of the last tick computed are not written yet, and are taken back. */
  const uint8_t last = (uint8_t)(kb_engine.tick - 1U + kb_engine.wide_ticks) & KB_WIDE_TICKS_MAX;
  kb_engine.held &= (uint8_t)~kb_engine.ends[last];
  kb_engine.ends[last] = 0;
  rest();
  const uint8_t computed = (uint8_t)(KB_TICKS_PER_PERIOD - kb_engine.ticks_left);
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    kb_engine.inc[axis] = 0;
    kb_engine.acc[axis] = KB_ACC_START;
  }
  *next_dropped = kb_engine.next_ready;
  kb_engine.next_ready = false;
  kb_engine.demand = false;
  kb_engine.late = false;
  kb_hal_unlock(saved);
  return computed == 0 ? 0 : (uint8_t)(computed - 1U);
}
