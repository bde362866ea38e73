/* SPDX-License-Identifier: Apache-2.0 */
/* Position of the belt: quadrature counts with the time of the last edge, an alpha-beta filter, and print
 * marks.
 *
 * The encoder interrupt comes on both edges of A, two counts apart. Between edges the position is that of the
 * last edge plus speed times the time since, at most the two counts to the next edge, so the filter sees no
 * staircase. Positions are in 1/256 count, modulo 2^32: only differences of them have a meaning. Times are in
 * units of KB_TIME_CYCLES (4 us on the AVR, 200 a period), modulo 2^16. */
#ifndef KERFBENCH_CONTROLLER_BELT_H
#define KERFBENCH_CONTROLLER_BELT_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware_under_test/controller/protocol.h"

enum { KB_TIME_PER_PERIOD = KB_PERIOD_CYCLES / KB_TIME_CYCLES };

struct kb_edge {
  uint8_t count; /* Low byte: the interrupt has little time, and the main loop comes each period. */
  uint16_t time;
  bool backwards;
};

struct kb_belt {
  /* Fields of the interrupts. */
  struct kb_edge edge;
  struct kb_edge mark_edge[KB_MARKS_MAX];
  uint16_t mark_time[KB_MARKS_MAX];
  uint8_t mark_end;
  uint8_t mark_lost;
  uint8_t errors; /* edges of A without a change of A, modulo 256 */
  /* Fields of the main loop. */
  int32_t position;   /* position at the last boundary, 1/256 count */
  int32_t speed;      /* speed per period, 1/65536 count */
  uint8_t mark_taken; /* next latch to be turned into a position */
  uint8_t mark_first; /* next mark to be used */
  uint16_t idle_periods;
  int32_t last_count; /* whole count at the last boundary */
  int32_t mark[KB_MARKS_MAX];
};

extern struct kb_belt kb_belt;

void kb_belt_init(void);
/* Updates the filter; called once a period, with the time of its boundary. */
void kb_belt_update(uint16_t boundary_time);
/* Forgets all marks seen. */
void kb_belt_clear_marks(void);
/* Oldest mark not yet used; false if none. kb_belt_drop_mark() uses it up. */
bool kb_belt_mark(int32_t* position);
void kb_belt_drop_mark(void);
bool kb_belt_marks_lost(void);
/* Position expected `periods` after the last boundary. */
int32_t kb_belt_ahead(uint8_t periods);
int32_t kb_belt_counts(void);
void kb_belt_clear_errors(void);

enum { KB_A = 2, KB_B = 2 };

/* Encoder interrupt at each edge of A, with the levels after it: KB_A and KB_B, or 0. */
static inline void kb_belt_edge(uint8_t a, uint8_t b, uint16_t now) {
  /* Bit 1 of the count is the opposite of A's level, from the second edge on. If A has not changed, two edges
   * came closer than the interrupt can follow: noise, or a belt far too fast. */
  uint8_t count = kb_belt.edge.count;
  if (((count ^ a) & KB_A) != 0) {
    kb_belt.errors = (uint8_t)(kb_belt.errors + 1U);
    return;
  }
#ifdef KB_DEFECT_ENCODER_SCALE
  /* Defect: a pulley of the wrong size in the configuration; every 400 counts read as 404. */
  static uint8_t edges;
  if (++edges == 200U) {
    edges = 0;
    count = (uint8_t)(a != b ? count + 4U : count - 4U);
  }
#endif
  /* A leads B forwards: behind an edge of A they differ. */
  if (a != b) {
    count = (uint8_t)(count + 2U);
    kb_belt.edge.backwards = false;
  } else {
    count = (uint8_t)(count - 2U);
    kb_belt.edge.backwards = true;
  }
  kb_belt.edge.count = count;
  kb_belt.edge.time = now;
}

/* Print mark interrupt at a rising edge. */
static inline void kb_belt_mark_edge(uint16_t now) {
  const uint8_t end = kb_belt.mark_end;
  const uint8_t next = (uint8_t)((end + 1U) & (KB_MARKS_MAX - 1U));
  if (next == kb_belt.mark_first) {
    kb_belt.mark_lost = 1;
    return;
  }
  /* Field by field: SDCC would call memcpy(), which the main loop may be in. */
  kb_belt.mark_edge[end].count = kb_belt.edge.count;
  kb_belt.mark_edge[end].time = kb_belt.edge.time;
  kb_belt.mark_edge[end].backwards = kb_belt.edge.backwards;
  kb_belt.mark_time[end] = now;
  kb_belt.mark_end = next;
}

#endif
