/* SPDX-License-Identifier: Apache-2.0 */
/* Where the belt is: quadrature counts with the time of the last edge, an alpha-beta filter, and print marks.
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
  int32_t count;
  uint16_t time;
  bool backwards;
};

struct kb_belt {
  /* Interrupts. */
  struct kb_edge edge;
  struct kb_edge mark_edge[KB_MARKS_MAX];
  uint16_t mark_time[KB_MARKS_MAX];
  uint8_t mark_end;
  uint8_t mark_lost;
  /* Main loop. */
  int32_t position;   /* at the last boundary, 1/256 count */
  int32_t speed;      /* per period, 1/65536 count */
  uint8_t mark_taken; /* next latch to be turned into a position */
  uint8_t mark_first; /* next mark to be used */
  uint16_t idle_periods;
  int32_t last_count;
  int32_t mark[KB_MARKS_MAX];
};

extern struct kb_belt kb_belt;

void kb_belt_init(void);
/* Once a period, with the time of its boundary. */
void kb_belt_update(uint16_t boundary_time);
/* Forgets all marks seen. */
void kb_belt_clear_marks(void);
/* The oldest mark not yet used; false if none. kb_belt_drop_mark() uses it up. */
bool kb_belt_mark(int32_t* position);
void kb_belt_drop_mark(void);
bool kb_belt_marks_lost(void);
/* Position expected `periods` after the last boundary. */
int32_t kb_belt_ahead(uint8_t periods);
int32_t kb_belt_counts(void);

/* Encoder interrupt, each edge of A, with the levels after it. */
static inline void kb_belt_edge(bool a, bool b, uint16_t now) {
#ifdef KB_DEFECT_ENCODER_SCALE
  /* Defect: a pulley of the wrong size in the configuration; every 100 counts read as 101. */
  static uint8_t edges;
  if (++edges == 50U) {
    edges = 0;
    kb_belt.edge.count += a != b ? 1 : -1;
  }
#endif
  /* A leads B forwards: behind an edge of A they differ. */
  if (a != b) {
    kb_belt.edge.count += 2;
    kb_belt.edge.backwards = false;
  } else {
    kb_belt.edge.count -= 2;
    kb_belt.edge.backwards = true;
  }
  kb_belt.edge.time = now;
}

/* Print mark interrupt, rising edge. */
static inline void kb_belt_mark_edge(uint16_t now) {
  const uint8_t end = kb_belt.mark_end;
  const uint8_t next = (uint8_t)((end + 1U) & (KB_MARKS_MAX - 1U));
  if (next == kb_belt.mark_first) {
    kb_belt.mark_lost = 1;
    return;
  }
  kb_belt.mark_edge[end] = kb_belt.edge;
  kb_belt.mark_time[end] = now;
  kb_belt.mark_end = next;
}

#endif
