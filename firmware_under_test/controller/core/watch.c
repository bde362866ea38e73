/* SPDX-License-Identifier: Apache-2.0 */
#include "watch.h"

#include <stdbool.h>
#include <stdint.h>

#include "belt.h"
#include "program.h"

static struct {
  uint32_t nominal; /* nominal travel of the window so far, 16.16 counts */
  int32_t from;     /* counts at the window's start */
  uint8_t periods;
  uint8_t fast_periods;
} w;

static void openWindow(void) {
  w.nominal = 0;
  w.periods = 0;
  w.from = kb_belt.last_count;
}

void kb_watch_start(void) {
  kb_belt_clear_errors();
  w.fast_periods = 0;
  openWindow();
}

/* Whether the counts of A and B cancel: A silent; B silent, which counts A to and fro; A and B exchanged. */
static bool encoderLost(uint32_t nominal_per_period) {
#ifdef KB_DEFECT_ENCODER_TRUSTED
  /* Defect: an encoder does not fail. */
  (void)nominal_per_period;
  return false;
#endif
  if (kb_belt.errors >= KB_ENCODER_ERRORS_MAX) {
    return true;
  }
  w.nominal += nominal_per_period;
  if (w.periods < UINT8_MAX) {
    w.periods++;
  }
  if (w.nominal >> 16 < KB_ENCODER_WINDOW_COUNTS || w.periods < 2) {
    return false;
  }
  const int32_t moved = (int32_t)((uint32_t)kb_belt.last_count - (uint32_t)w.from);
  const bool lost = moved < (int32_t)(w.nominal >> 18);
  openWindow();
  return lost;
}

enum kb_fault kb_watch_belt(void) {
  const struct kb_config* const config = kb_program_config();
  if (!kb_program_follows() || config->nominal_per_period == 0) {
    openWindow();
  } else if (encoderLost(config->nominal_per_period)) {
    return KB_FAULT_ENCODER;
  }
  const bool fast = config->max_per_period != 0 && kb_belt.speed > (int32_t)config->max_per_period;
  if (!fast && !kb_program_lags()) {
    w.fast_periods = 0;
  } else if (++w.fast_periods >= KB_BELT_FAST_PERIODS) {
    return KB_FAULT_BELT_FAST;
  }
  return KB_OK;
}
