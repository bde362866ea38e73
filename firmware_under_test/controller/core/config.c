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

static uint32_t u32At(const uint8_t* bytes) {
  return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static bool fieldFits(const struct kb_config* config) {
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    if (config->lowest[axis] > config->highest[axis]) {
      return false;
    }
  }
  return true;
}

bool kb_config_read(const uint8_t* payload, struct kb_config* config) {
  const uint8_t* const b = payload;
  config->nominal_per_period = u32At(b);
  config->gate_on_delay = (uint16_t)(b[4] | (uint16_t)b[11] << 8);
  config->gate_off_delay = (uint16_t)(b[5] | (uint16_t)b[12] << 8);
  config->idle_power = b[6];
  config->max_per_period = u32At(b + 7);
  config->invert_a = b[13];
  config->invert_c = b[14];
  config->wide = b[15];
  config->wide_ticks = b[16];
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    config->most_steps[axis] = b[17 + axis];
    config->turn_steps[axis] = b[22 + axis];
  }
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    config->lowest[axis] = (int32_t)u32At(b + 27 + 4 * axis);
    config->highest[axis] = (int32_t)u32At(b + 27 + 4 * (KB_AXES + axis));
  }
  return config->max_per_period <= INT32_MAX && delaysFit(config) && drivesFit(config) && fieldFits(config);
}
