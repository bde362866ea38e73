/* SPDX-License-Identifier: Apache-2.0 */
/* Interpreter of the program: turns operations from the queue into periods for the step engine. */
#ifndef KERFBENCH_CONTROLLER_PROGRAM_H
#define KERFBENCH_CONTROLLER_PROGRAM_H

#include <stdbool.h>
#include <stdint.h>

#include "config.h"

enum kb_step { KB_STEP_ON, KB_STEP_DONE, KB_STEP_FAULT };

void kb_program_init(void);
void kb_program_configure(const struct kb_config* config);
bool kb_program_configured(void);
/* Starts the program. The configuration is used up: the next start needs one of its own. */
void kb_program_start(void);
/* Turns the laser off at once and slows the axes down in the periods to come; then kb_program_step() returns
 * this fault. The first fault counts. */
void kb_program_ramp(enum kb_fault fault);
/* Fault that the axes slow down for, or KB_OK. */
enum kb_fault kb_program_ramping(void);
/* True while the axes have to follow the belt. */
bool kb_program_follows(void);
/* True if the following axis misses more steps than a period can hold, and the laser is on. */
bool kb_program_lags(void);
const struct kb_config* kb_program_config(void);
/* Prepares the next period and offers it to the engine, which must be able to take one. There may be no
 * period to offer yet. */
enum kb_step kb_program_step(enum kb_fault* fault);
/* Halts axes and laser at once, and corrects the positions for the steps that were not output. */
void kb_program_halt(void);
int32_t kb_program_position(uint8_t axis);

#endif
