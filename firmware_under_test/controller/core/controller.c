/* SPDX-License-Identifier: Apache-2.0 */
#include "controller.h"

#include <string.h>

#include "belt.h"
#include "engine.h"
#include "firmware_under_test/controller/release.h"
#include "frame.h"
#include "hal.h"
#include "power_loop.h"
#include "program.h"
#include "queue.h"
#include "watch.h"

enum { KB_FRAME_PAUSE_PERIODS = KB_PERIODS_IN_MS(20) };

static struct {
  uint8_t state;
  uint8_t fault;
  uint8_t boundaries;    /* boundaries seen */
  uint8_t quiet_periods; /* periods since the last byte */
  uint8_t line_errors;   /* line errors since the last frame accepted */
  uint16_t silent_periods;
#ifdef KB_DEFECT_MAIN_STUCK
  bool stuck;
#endif
  bool event_due;
  bool answered; /* true if last_type and last_seq hold */
  uint8_t last_type;
  uint8_t last_seq;
} c;

void kb_controller_init(enum kb_fault reset_cause) {
  kb_engine_init();
  kb_belt_init();
  kb_program_init();
  kb_power_init();
  kb_frame_init();
  c.state = reset_cause == KB_OK ? KB_IDLE : KB_STOPPED;
  c.fault = (uint8_t)reset_cause;
  c.boundaries = 0;
  c.quiet_periods = 0;
  c.line_errors = 0;
  c.silent_periods = 0;
  c.event_due = reset_cause != KB_OK;
  c.answered = false;
#ifdef KB_DEFECT_MAIN_STUCK
  c.stuck = false;
#endif
}

static void enter(uint8_t state, uint8_t fault) {
  if (state != c.state || fault != c.fault) {
    c.state = state;
    c.fault = fault;
    c.event_due = true;
  }
}

/* Stops once the axes stand. The fault that they slowed down for came first, and is reported. */
static void stop(enum kb_fault fault) {
  const enum kb_fault first = kb_program_ramping();
  kb_program_halt();
  enter(KB_STOPPED, (uint8_t)(first != KB_OK ? first : fault));
}

static void lineErrors(uint8_t more) {
  c.line_errors =
      more > KB_LINE_ERRORS_MAX - c.line_errors ? KB_LINE_ERRORS_MAX : (uint8_t)(c.line_errors + more);
}

static uint8_t putU16(uint8_t* to, uint16_t value) {
  to[0] = (uint8_t)value;
  to[1] = (uint8_t)(value >> 8);
  return 2;
}

static uint8_t putI32(uint8_t* to, int32_t value) {
  putU16(to, (uint16_t)value);
  putU16(to + 2, (uint16_t)((uint32_t)value >> 16));
  return 4;
}

static void ack(uint8_t seq) {
  uint8_t payload[2];
  kb_frame_send(KB_ACK, seq, payload, putU16(payload, kb_queue_free()));
}

static void sendInfo(uint8_t seq) {
  uint8_t payload[6 + KB_RELEASE_LEN];
  payload[0] = KB_PROTOCOL_VERSION;
  putU16(payload + 1, KB_QUEUE_SIZE);
  putU16(payload + 3, KB_TICK_CYCLES);
  payload[5] = KB_TICKS_PER_PERIOD;
  memcpy(payload + 6, &kb_release, KB_RELEASE_LEN);
  kb_frame_send(KB_INFO, seq, payload, sizeof(payload));
}

static void sendState(uint8_t seq) {
  uint8_t payload[8 + 4 * KB_AXES];
  payload[0] = c.state;
  payload[1] = c.fault;
  uint8_t at = 2;
  at = (uint8_t)(at + putU16(payload + at, kb_queue_free()));
  at = (uint8_t)(at + putI32(payload + at, kb_belt_counts()));
  for (uint8_t axis = 0; axis < KB_AXES; ++axis) {
    at = (uint8_t)(at + putI32(payload + at, kb_program_position(axis)));
  }
  kb_frame_send(KB_STATE, seq, payload, at);
}

static uint8_t configure(const struct kb_frame* frame) {
  if (c.state == KB_RUNNING) {
    return KB_NAK_STATE;
  }
  if (frame->length != KB_CONFIG_LEN) {
    return KB_NAK_LENGTH;
  }
  struct kb_config config;
  if (!kb_config_read(frame->payload, &config)) {
    return KB_NAK_VALUE;
  }
  kb_program_configure(&config);
  kb_power_init();
  kb_queue_clear();
  kb_job_check.a = 1;
  kb_job_check.b = 0;
  for (uint8_t i = 0; i < KB_CONFIG_LEN; ++i) {
    kb_check_add(&kb_job_check, frame->payload[i]);
  }
  enter(KB_IDLE, KB_OK);
  return 0;
}

static uint8_t closeLoop(const struct kb_frame* frame) {
  if (c.state != KB_IDLE || !kb_program_configured()) {
    return KB_NAK_STATE;
  }
  if (frame->length != 0 && frame->length != KB_POWER_LEN) {
    return KB_NAK_LENGTH;
  }
  if (!kb_power_configure(frame->payload, frame->length)) {
    return KB_NAK_VALUE;
  }
  for (uint8_t i = 0; i < frame->length; ++i) {
    kb_check_add(&kb_job_check, frame->payload[i]);
  }
  return 0;
}

static uint8_t start(const struct kb_frame* frame) {
  if (frame->length != KB_CHECK_LEN) {
    return KB_NAK_LENGTH;
  }
  if (c.state != KB_IDLE || !kb_program_configured() || kb_queue_empty()) {
    return KB_NAK_STATE;
  }
  for (uint8_t i = 0; i < KB_CHECK_LEN; ++i) {
    if (!kb_check_holds(&kb_job_check, i, frame->payload[i])) {
      return KB_NAK_CHECK;
    }
  }
  kb_program_start();
  kb_watch_start();
  c.silent_periods = 0;
  enter(KB_RUNNING, KB_OK);
  return 0;
}

/* Executes a request; 0, or the reason of a refusal. */
static uint8_t execute(const struct kb_frame* frame) {
  const bool bare = frame->type == KB_HELLO || frame->type == KB_STOP || frame->type == KB_STATUS;
  if (bare && frame->length != 0) {
    return KB_NAK_LENGTH;
  }
  switch (frame->type) {
    case KB_HELLO:
      if (c.state != KB_RUNNING) {
        kb_queue_clear();
        enter(KB_IDLE, KB_OK);
      }
      return 0;
    case KB_CONFIG:
      return configure(frame);
    case KB_DATA:
      if (c.state == KB_DONE || c.state == KB_STOPPED) {
        return KB_NAK_STATE;
      }
      kb_queue_commit((uint8_t)(frame->length - KB_CHECK_LEN));
      kb_frame_commit();
      return 0;
    case KB_POWER:
      return closeLoop(frame);
    case KB_START:
      return start(frame);
    case KB_STOP:
      if (c.state == KB_RUNNING) {
        stop(KB_OK);
      } else {
        kb_queue_clear();
        enter(KB_IDLE, KB_OK);
      }
      return 0;
    case KB_STATUS:
      return 0;
    default:
      return KB_NAK_TYPE;
  }
}

static void answer(const struct kb_frame* frame) {
  uint8_t nak = frame->nak;
  /* A lost answer makes the host repeat a request that was executed. A repeat of data may not fit. */
  const bool repeated = (nak == 0 || nak == KB_NAK_FULL || nak == KB_NAK_CHECK) && c.answered &&
                        frame->type == c.last_type && frame->seq == c.last_seq && frame->type != KB_HELLO;
  if (repeated) {
    nak = 0;
  } else if (nak == 0) {
    nak = execute(frame);
  }
  if (nak != 0) {
    lineErrors(nak == KB_NAK_CRC ? 1 : 0);
    kb_frame_send(KB_NAK, frame->seq, &nak, 1);
    return;
  }
  c.line_errors = 0;
  c.silent_periods = 0;
  c.answered = true;
  c.last_type = frame->type;
  c.last_seq = frame->seq;
  ack(frame->seq);
  if (frame->type == KB_HELLO) {
    sendInfo(frame->seq);
  } else if (frame->type == KB_STATUS) {
    sendState(frame->seq);
  }
}

static void receive(void) {
  uint8_t byte;
  struct kb_frame frame;
  /* Only a few bytes are taken at a time: the next period must not wait for a burst. */
  if (kb_frame_take(4) != 0) {
    c.quiet_periods = 0;
    return;
  }
  for (uint8_t i = 0; i < 4 && kb_hal_rx(&byte); ++i) {
    c.quiet_periods = 0;
    if (kb_frame_byte(byte, &frame)) {
      answer(&frame);
    }
  }
}

/* Watches for faults that let the axes slow down. */
static void watch(void) {
  if (c.silent_periods < KB_SILENCE_PERIODS) {
    c.silent_periods++;
  }
  enum kb_fault fault = kb_watch_belt();
  if (c.silent_periods >= KB_SILENCE_PERIODS) {
    fault = KB_FAULT_SILENT;
  } else if (c.line_errors >= KB_LINE_ERRORS_MAX) {
    fault = KB_FAULT_UART;
  } else if (kb_belt_marks_lost()) {
    fault = KB_FAULT_MARKS;
  }
  if (fault != KB_OK) {
    kb_program_ramp(fault);
  }
}

static void newPeriod(void) {
  const uint8_t saved = kb_hal_lock();
  const uint16_t boundary_time = kb_engine.boundary_time;
  const uint8_t power_counter = kb_power_counter;
  c.boundaries = kb_engine.boundaries;
  kb_hal_unlock(saved);
  kb_power_boundary(power_counter);
  kb_belt_update(boundary_time);
  lineErrors(kb_hal_rx_errors());
  kb_hal_feed_watchdog(); /* Both the tick and the main loop are alive. */
  if (c.quiet_periods < KB_FRAME_PAUSE_PERIODS) {
    c.quiet_periods++;
  } else {
#ifdef KB_DEFECT_MAIN_STUCK
    c.stuck = c.state == KB_RUNNING && kb_frame_begun();
#endif
#ifdef KB_DEFECT_LOG_WAITS
    /* Defect: a broken frame is recorded in an EEPROM, and the main loop waits until that is written. */
    if (c.state == KB_RUNNING && kb_frame_begun()) {
      for (volatile uint16_t wait = 0; wait < 3000U; ++wait) {
      }
    }
#endif
    kb_frame_forget();
  }
  if (c.state == KB_RUNNING) {
    watch();
  }
}

static void run(void) {
  uint8_t inputs = kb_hal_inputs();
#ifdef KB_DEFECT_INTERLOCK_IGNORED
  /* Defect: a bridge from the commissioning is still in place. */
  inputs |= KB_IN_INTERLOCK;
#endif
  if (!(inputs & KB_IN_INTERLOCK)) {
    stop(KB_FAULT_INTERLOCK);
    return;
  }
  if (inputs & KB_IN_LIMITS) {
    stop(KB_FAULT_LIMIT);
    return;
  }
  if (kb_engine.late) {
    stop(KB_FAULT_LATE);
    return;
  }
  /* The order matters: a boundary that came since newPeriod() has not been seen by the belt filter yet. */
  if (kb_engine.next_ready || c.boundaries != kb_engine.boundaries) {
    return;
  }
  enum kb_fault fault = KB_OK;
  const enum kb_step step = kb_program_step(&fault);
  if (step == KB_STEP_FAULT) {
    stop(fault);
  } else if (step == KB_STEP_DONE) {
    kb_engine.demand = false;
    enter(KB_DONE, KB_OK);
  } else if (kb_engine.next_ready) {
    kb_engine.demand = true; /* Demand begins with the first period. */
  }
}

void kb_controller_poll(void) {
#ifdef KB_DEFECT_MAIN_STUCK
  /* Defect: the main loop waits for the rest of a frame for ever. */
  if (c.stuck) {
#ifdef KB_DEFECT_ALL_STUCK
    (void)kb_hal_lock();
    for (;;) {
    }
#endif
    return;
  }
#endif
  if (c.boundaries != kb_engine.boundaries) {
    newPeriod();
  }
  if (c.state == KB_RUNNING) {
    run();
  }
  receive();
  if (c.event_due) {
    const uint8_t payload[2] = {c.state, c.fault};
    c.event_due = !kb_frame_send(KB_EVENT, 0, payload, sizeof(payload));
  }
  kb_frame_pump();
}
