/* SPDX-License-Identifier: Apache-2.0 */
/* The program: a ring buffer of operations, and the interpreter that turns them into periods for the step
 * engine. */
#ifndef KERFBENCH_CONTROLLER_PROGRAM_H
#define KERFBENCH_CONTROLLER_PROGRAM_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware_under_test/controller/protocol.h"

struct kb_config {
  uint32_t nominal_per_period;
  uint16_t gate_on_delay; /* ticks */
  uint16_t gate_off_delay;
  uint8_t idle_power;
  uint32_t max_per_period;
  uint8_t invert_a;
  uint8_t invert_c;
  uint8_t wide; /* mask of axes */
  uint8_t wide_ticks;
  uint8_t most_steps[KB_AXES];
  uint8_t turn_steps[KB_AXES];
};

enum kb_step { KB_STEP_ON, KB_STEP_DONE, KB_STEP_FAULT };

/* Queue. Bytes are put behind the end and count only once committed, so that a frame with a bad CRC leaves no
 * trace. */
void kb_queue_clear(void);
uint16_t kb_queue_free(void);
bool kb_queue_empty(void);
void kb_queue_put(uint8_t offset, uint8_t byte);
/* The place `offset` bytes behind the end, and a byte stored there; returns the next place. */
uint16_t kb_queue_end(uint8_t offset);
uint16_t kb_queue_store(uint16_t at, uint8_t byte);
void kb_queue_commit(uint8_t length);

void kb_program_init(void);
/* False where gate delays differ by a period or more (their order could turn round) or are too long, and
 * where pulses would overlap. */
bool kb_program_configure(const struct kb_config* config);
bool kb_program_configured(void);
/* Uses the configuration up: the next start needs one of its own. */
void kb_program_start(void);
/* Laser off at once, and the axes slow down in the periods to come; then kb_program_step() gives this fault.
 * The first fault counts. */
void kb_program_ramp(enum kb_fault fault);
/* What the axes slow down for, or KB_OK. */
enum kb_fault kb_program_ramping(void);
/* True while the axes have to be with the belt. */
bool kb_program_follows(void);
/* More steps are missing on the axis that follows than a period can hold, and the laser is on. */
bool kb_program_lags(void);
const struct kb_config* kb_program_config(void);
/* Prepares the next period and offers it to the engine, which must be able to take one. It may offer none
 * yet. */
enum kb_step kb_program_step(enum kb_fault* fault);
/* Halts axes and laser at once, and corrects the positions for what was not output. */
void kb_program_halt(void);
int32_t kb_program_position(uint8_t axis);

#endif
