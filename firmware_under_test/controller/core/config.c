/* SPDX-License-Identifier: Apache-2.0 */
#include "config.h"

#include "engine.h"

static bool drivesFit(const struct kb_config* config) {
  if ((config->invert_c & (uint8_t) ~(KB_FEED_PUL | KB_FEED_DIR)) != 0 ||
      (config->wide & (uint8_t) ~((1U << KB_AXES) - 1U)) != 0 || config->wide_ticks > KB_WIDE_TICKS_MAX ||
      (config->wide != 0 && config->wide_ticks == 0)) {
    return false;
  }
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    const uint8_t most = config->most_steps[axis];
    const uint8_t wide = (config->wide & (uint8_t)(1U << axis)) ? config->wide_ticks : 0;
    if (most > KB_MAX_STEPS_PER_PERIOD || config->turn_steps[axis] > most ||
        (uint16_t)(most * (wide + 1U)) > KB_TICKS_PER_PERIOD) {
      return false;
    }
  }
  return true;
}

static bool delaysFit(const struct kb_config* config) {
  const uint16_t on = config->gate_on_delay;
  const uint16_t off = config->gate_off_delay;
  const uint16_t apart = on > off ? (uint16_t)(on - off) : (uint16_t)(off - on);
  return apart < KB_TICKS_PER_PERIOD && on <= KB_LONGEST_DELAY_TICKS && off <= KB_LONGEST_DELAY_TICKS;
}

bool kb_config_read(const uint8_t* payload, struct kb_config* config) {
  const uint8_t* const b = payload;
  *config = (struct kb_config){
      .nominal_per_period =
          (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24,
      .gate_on_delay = (uint16_t)(b[4] | (uint16_t)b[11] << 8),
      .gate_off_delay = (uint16_t)(b[5] | (uint16_t)b[12] << 8),
      .idle_power = b[6],
      .max_per_period = (uint32_t)b[7] | (uint32_t)b[8] << 8 | (uint32_t)b[9] << 16 | (uint32_t)b[10] << 24,
      .invert_a = b[13],
      .invert_c = b[14],
      .wide = b[15],
      .wide_ticks = b[16],
      .most_steps = {b[17], b[18], b[19], b[20], b[21]},
      .turn_steps = {b[22], b[23], b[24], b[25], b[26]},
  };
  return config->max_per_period <= INT32_MAX && delaysFit(config) && drivesFit(config);
}
