/* SPDX-License-Identifier: Apache-2.0 */
/* KB_CONFIG's payload (protocol.h). */
#ifndef KERFBENCH_CONTROLLER_CONFIG_H
#define KERFBENCH_CONTROLLER_CONFIG_H

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
  uint8_t wide; /* mask of the axes with wide pulses */
  uint8_t wide_ticks;
  uint8_t most_steps[KB_AXES];
  uint8_t turn_steps[KB_AXES];
  int32_t lowest[KB_AXES]; /* lowest step of the field */
  int32_t highest[KB_AXES];
};

/* Reads a configuration. False where the belt's highest speed is zero, gate delays differ by a period or more
 * (their order could change) or are too long, where pulses would overlap, and where a field ends before it
 * begins. */
bool kb_config_read(const uint8_t* payload, struct kb_config* config);

#endif
