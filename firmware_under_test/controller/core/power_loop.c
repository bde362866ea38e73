/* SPDX-License-Identifier: Apache-2.0 */
#include "power_loop.h"

#include <string.h>

enum {
  /* ring length in periods; more than KB_POWER_DELAY_MAX ticks and the periods that are compared */
  KB_RING = 16,
  KB_RING_MASK = KB_RING - 1,
  KB_TRIM_ONE = 16384,
  KB_TRIM_LEAST = KB_TRIM_ONE / 2,
  KB_TRIM_MOST = 32767,
  KB_COUNT = 16,            /* the table's unit is 1/16 edge */
  KB_FEWEST = 4 * KB_COUNT, /* fewest edges of a period that can be evaluated */
  KB_SILENT_PERIODS = 4
};

volatile uint8_t kb_power_counter;

static struct {
  bool on;
  uint8_t gain; /* 1/256 */
  uint8_t least;
  uint8_t most;
  uint8_t delay_periods;
  uint8_t delay_ticks; /* ticks of the delay beyond delay_periods */
  uint16_t table[KB_POWER_POINTS];
  uint16_t wanted[KB_RING]; /* wanted edges of each period, 1/16 edge; 0: dark; [at] runs now */
  uint8_t at;
  uint16_t offered;
  uint8_t counter;
  uint8_t silent;
  uint16_t trim;
} w;

void kb_power_init(void) {
  memset(&w, 0, sizeof(w));
  w.trim = KB_TRIM_ONE;
}

static uint16_t u16(const uint8_t* from) { return (uint16_t)(from[0] | (uint16_t)from[1] << 8); }

bool kb_power_configure(const uint8_t* payload, uint8_t length) {
  w.on = false;
  if (length == 0) {
    return true;
  }
  const uint16_t delay = u16(payload + 3);
  if (payload[0] == 0 || payload[1] > payload[2] || delay > KB_POWER_DELAY_MAX) {
    return false;
  }
  for (uint8_t i = 0; i < KB_POWER_POINTS; ++i) {
    w.table[i] = u16(payload + 5 + 2 * i);
    if (i > 0 && w.table[i] < w.table[i - 1]) {
      return false;
    }
  }
  w.gain = payload[0];
  w.least = payload[1];
  w.most = payload[2];
  w.delay_periods = (uint8_t)(delay / KB_TICKS_PER_PERIOD);
  w.delay_ticks = (uint8_t)(delay % KB_TICKS_PER_PERIOD);
  w.trim = KB_TRIM_ONE;
  w.silent = 0;
  w.offered = 0;
  memset(w.wanted, 0, sizeof(w.wanted));
  w.on = true;
  return true;
}

uint16_t kb_power_trim(void) { return w.trim; }

static uint16_t wantedAgo(uint8_t periods) { return w.wanted[(uint8_t)(w.at - periods) & KB_RING_MASK]; }

static void learn(uint8_t measured) {
  /* The period that has just ended saw the end of one wanted period and the start of the next. */
  const uint16_t later = wantedAgo((uint8_t)(w.delay_periods + 1U));
  const uint16_t earlier = wantedAgo((uint8_t)(w.delay_periods + 2U));
  const uint16_t before = wantedAgo((uint8_t)(w.delay_periods + 3U));
  const uint8_t t = w.delay_ticks;
  const uint16_t wanted =
      (uint16_t)(((uint32_t)later * (KB_TICKS_PER_PERIOD - t) + (uint32_t)earlier * t) / KB_TICKS_PER_PERIOD);
  if (later == 0 || earlier == 0 || before == 0 || wanted < KB_FEWEST) {
    return;
  }
  if (measured == 0) {
    if (w.silent < KB_SILENT_PERIODS && ++w.silent == KB_SILENT_PERIODS) {
      w.trim = KB_TRIM_ONE;
    }
    return;
  }
  w.silent = 0;
  int32_t error = (int32_t)wanted - (int32_t)measured * KB_COUNT;
  /* A reading of more than twice the wanted value counts as twice. */
  if (error < -(int32_t)wanted) {
    error = -(int32_t)wanted;
  }
  int32_t trim = (int32_t)w.trim + error * w.gain * (KB_TRIM_ONE / 256) / (int32_t)wanted;
  trim = trim < KB_TRIM_LEAST ? KB_TRIM_LEAST : trim > KB_TRIM_MOST ? KB_TRIM_MOST : trim;
  w.trim = (uint16_t)trim;
}

void kb_power_boundary(uint8_t counter) {
  const uint8_t measured = (uint8_t)(counter - w.counter);
  w.counter = counter;
  if (!w.on) {
    return;
  }
  w.at = (uint8_t)((w.at + 1U) & KB_RING_MASK);
  w.wanted[w.at] = w.offered;
  w.offered = 0;
  learn(measured);
}

/* Spacing of the table: points lie at 0, 16, … 240 and 255. */
static uint8_t spanOf(uint8_t point) { return point == KB_POWER_POINTS - 2 ? 15 : 16; }

static uint16_t tableAt(uint8_t power) {
  const uint8_t i = power >> 4;
  const uint16_t rise = (uint16_t)(w.table[i + 1U] - w.table[i]);
  return (uint16_t)(w.table[i] + (uint32_t)rise * (power & 15U) / spanOf(i));
}

static uint8_t inverse(uint32_t wanted) {
  uint8_t i = KB_POWER_POINTS - 2;
  if (wanted >= w.table[KB_POWER_POINTS - 1]) {
    return 255;
  }
  while (i > 0 && w.table[i] > wanted) {
    --i;
  }
  const uint16_t rise = (uint16_t)(w.table[i + 1U] - w.table[i]);
  if (rise == 0 || wanted <= w.table[i]) {
    return (uint8_t)(i << 4);
  }
  return (uint8_t)((uint8_t)(i << 4) + (uint8_t)(((wanted - w.table[i]) * spanOf(i) + rise / 2U) / rise));
}

uint8_t kb_power_command(bool lit, uint8_t power) {
  if (!w.on || !lit) {
    w.offered = 0;
    return power;
  }
  w.offered = tableAt(power);
  const uint8_t byte = inverse(((uint32_t)w.offered * w.trim) / KB_TRIM_ONE);
  return byte < w.least ? w.least : byte > w.most ? w.most : byte;
}
