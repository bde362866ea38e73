/* SPDX-License-Identifier: Apache-2.0 */
#include "belt.h"

#include <string.h>

#include "hal.h"

struct kb_belt kb_belt;

/* Periods without an edge after which the belt stands: slower than 1 mm/s at 0.01 mm a count. */
enum { KB_STANDING_PERIODS = KB_PERIODS_IN_MS(24) };

void kb_belt_init(void) {
  const uint8_t saved = kb_hal_lock();
  memset(&kb_belt, 0, sizeof(kb_belt));
  kb_belt.idle_periods = KB_STANDING_PERIODS;
  kb_hal_unlock(saved);
}

/* Whole count from its low byte, within half its range of the last one. */
static int32_t wholeCount(uint8_t low) {
  return kb_belt.last_count + (int8_t)(uint8_t)(low - (uint8_t)(uint32_t)kb_belt.last_count);
}

/* Position at `time` from an edge, in 1/256 count. */
static int32_t interpolate(const struct kb_edge* edge, uint16_t time, bool standing) {
  /* An edge at count c means that [c, c + 2) lies behind it when passed forwards; the same edge passed
   * backwards leaves c - 2. */
  const int32_t count = wholeCount(edge->count) + (edge->backwards ? 2 : 0);
  const int32_t base = (int32_t)((uint32_t)count * 256U);
  if (standing) {
    return base + (edge->backwards ? -256 : 256); /* half-way to the next edge */
  }
  const int16_t age = (int16_t)(time - edge->time);
  const int16_t speed = (int16_t)(kb_belt.speed >> 8); /* 1/256 count per period; 40 counts a period fit */
#if KB_PERIOD_CYCLES / KB_TIME_CYCLES == 200
  /* age / 200 as 328 / 65536, in two shifts to stay inside 32 bits. */
  const int32_t moved = ((((int32_t)speed * age) >> 8) * 328) >> 8;
#else
  const int32_t moved = (int32_t)speed * age / KB_TIME_PER_PERIOD;
#endif
  const int32_t forwards = edge->backwards ? -moved : moved;
  int32_t part = forwards;
  if (part > 512) {
    part = 512;
  } else if (part < -512 && age >= 0) { /* the belt has just turned */
    part = -512;
  } /* An edge later than the boundary, by more than one where the main loop was busy, leads back without a
       limit. */
  return base + (edge->backwards ? -part : part);
}

void kb_belt_update(uint16_t boundary_time) {
  struct kb_edge edge;
  const uint8_t saved = kb_hal_lock();
  edge = kb_belt.edge;
  kb_hal_unlock(saved);

  if (edge.count != (uint8_t)(uint32_t)kb_belt.last_count) {
    kb_belt.last_count = wholeCount(edge.count);
    kb_belt.idle_periods = 0;
  } else if (kb_belt.idle_periods < KB_STANDING_PERIODS) {
    kb_belt.idle_periods++;
  }
  const bool standing = kb_belt.idle_periods >= KB_STANDING_PERIODS;
#ifdef KB_DEFECT_BELT_LATE
  /* Defect: the position of 100 us ago is taken for the present one. */
  const int32_t measured =
      interpolate(&edge, (uint16_t)(boundary_time - KB_CPU_HZ / 10000UL / KB_TIME_CYCLES), standing);
#else
  const int32_t measured = interpolate(&edge, boundary_time, standing);
#endif
  const int32_t expected = (int32_t)((uint32_t)kb_belt.position + (uint32_t)(kb_belt.speed >> 8));
  const int32_t residual = (int32_t)((uint32_t)measured - (uint32_t)expected);
  if (standing || residual > 0x4000 || residual < -0x4000) {
    kb_belt.position = measured;
    kb_belt.speed = 0;
  } else {
    /* Filter with alpha 1/2, beta 1/8: settles in about ten periods; an acceleration of 1 m/s^2 lags by half
     * a count. */
    kb_belt.position = (int32_t)((uint32_t)expected + (uint32_t)((residual + 1) >> 1));
    kb_belt.speed += residual * 32;
  }

  while (kb_belt.mark_taken != kb_belt.mark_end) {
    const uint8_t i = kb_belt.mark_taken;
    kb_belt.mark[i] = interpolate(&kb_belt.mark_edge[i], kb_belt.mark_time[i], standing);
    kb_belt.mark_taken = (uint8_t)((i + 1U) & (KB_MARKS_MAX - 1U));
  }
}

void kb_belt_clear_marks(void) {
  const uint8_t saved = kb_hal_lock();
  kb_belt.mark_first = kb_belt.mark_end;
  kb_belt.mark_taken = kb_belt.mark_end;
  kb_belt.mark_lost = 0;
  kb_hal_unlock(saved);
}

bool kb_belt_mark(int32_t* position) {
  if (kb_belt.mark_first == kb_belt.mark_taken) {
    return false;
  }
  *position = kb_belt.mark[kb_belt.mark_first];
  return true;
}

void kb_belt_drop_mark(void) {
  const uint8_t saved = kb_hal_lock();
  kb_belt.mark_first = (uint8_t)((kb_belt.mark_first + 1U) & (KB_MARKS_MAX - 1U));
  kb_hal_unlock(saved);
}

bool kb_belt_marks_lost(void) { return *(volatile uint8_t*)&kb_belt.mark_lost != 0; }

int32_t kb_belt_ahead(uint8_t periods) {
  return (int32_t)((uint32_t)kb_belt.position + (uint32_t)((kb_belt.speed * periods) >> 8));
}

int32_t kb_belt_counts(void) { return kb_belt.position >> 8; }

void kb_belt_clear_errors(void) {
  const uint8_t saved = kb_hal_lock();
  kb_belt.errors = 0;
  kb_hal_unlock(saved);
}
