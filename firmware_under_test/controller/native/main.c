/* SPDX-License-Identifier: Apache-2.0 */
/* The core as a program that speaks hil/source/pin_stream.h: the same steps as on the AVR, at the same ticks,
 * without an emulator. Interrupts take no time here; pins change at distances from the tick that are
 * estimated from the AVR release's timing under simavr. */
#include <stdio.h>
#include <string.h>

#include "firmware_under_test/controller/core/belt.h"
#include "firmware_under_test/controller/core/controller.h"
#include "firmware_under_test/controller/core/engine.h"
#include "firmware_under_test/controller/core/power_loop.h"
#include "hal.h"
#include "hil/source/pin_stream.h"
#include "message.h"

enum {
#ifdef KB_TARGET_GALVO
  /* Timing of a pulse generator in logic: PUL high for 7 cycles of 62.5 ns, low for at least 9; DIR changes 8
   * before an edge of PUL. */
  KB_RISE_CYCLES = 1, /* cycles from the tick to the first store */
  KB_FALL_CYCLES = 8, /* cycles from the tick to PUL low and DIR */
#else
  KB_RISE_CYCLES = 50,
  KB_FALL_CYCLES = 157,
#endif
  KB_BYTE_CYCLES = 10 * KB_CPU_HZ / KB_BAUD,
  KB_WATCHDOG_CYCLES = 16 * (KB_CPU_HZ / 1000), /* 16 ms, as on the AVR */
  KB_PORT_A = 0,
  KB_PORT_C = 2,
  KB_PORT_D = 3,
  KB_PORT_H = 7,
  KB_PORT_L = 11,
  KB_EVENT_BYTES = 16
};

static struct {
  uint64_t now;
  uint64_t next_tick;
  uint64_t next_byte; /* earliest end of the next byte on the wire to the controller */
  uint64_t tx_free;
  uint64_t fed; /* time at which the watchdog was last reset */
  uint8_t port_d;
  uint8_t port_l;
  bool power_level;
  uint8_t power_edges; /* rising edges of the power meter */
  uint8_t level[4];    /* levels of the output ports, by number */
  bool rx_full;
  uint8_t rx_errors;
  uint8_t rx_byte;
  uint64_t max_events;
  struct kb_buffer drives; /* levels to be driven: u64 tick, u8 port, u8 bit, u8 level */
  struct kb_buffer rx;     /* bytes under way to the controller */
  struct kb_buffer tx;     /* bytes from the controller */
  struct kb_buffer events; /* events in the format of the wire; some may lie behind the watermark */
} m;

uint8_t kb_hal_inputs(void) { return m.port_l & 0x07U; }

bool kb_hal_rx(uint8_t* byte) {
  const bool full = m.rx_full;
  *byte = m.rx_byte;
  m.rx_full = false;
  return full;
}

/* Line errors. The wire is a pipe without framing errors; a byte not taken before the next is an overrun. */
uint8_t kb_hal_rx_errors(void) {
  const uint8_t errors = m.rx_errors;
  m.rx_errors = 0;
  return errors;
}

void kb_hal_feed_watchdog(void) { m.fed = m.now; }

bool kb_hal_tx_ready(void) { return m.now >= m.tx_free; }

void kb_hal_tx(uint8_t byte) {
  kb_put_uint(&m.tx, byte, 1);
  m.tx_free = m.now + KB_BYTE_CYCLES;
}

static uint16_t timeNow(void) { return (uint16_t)(m.now / KB_TIME_CYCLES); }

static void writePort(uint64_t at, uint8_t port, uint8_t level) {
  const uint8_t changed = m.level[port] ^ level;
  if (changed == 0) {
    return;
  }
  m.level[port] = level;
  kb_put_uint(&m.events, at, 8);
  kb_put_uint(&m.events, port, 2);
  kb_put_uint(&m.events, changed, 2);
  kb_put_uint(&m.events, level, 2);
  kb_put_uint(&m.events, 0, 2);
}

static void tick(void) {
  writePort(m.now + KB_RISE_CYCLES, KB_PORT_A, kb_engine.out_a);
  writePort(m.now + KB_RISE_CYCLES, KB_PORT_C, kb_engine.out_c);
  const uint8_t held = kb_engine.held;
  const uint8_t out_c = kb_engine.out_c;
  if (kb_tick_begins_period()) {
    kb_tick_boundary(timeNow());
    kb_power_counter = m.power_edges;
  }
  kb_tick_compute(m.port_l & 0x07U, true);
  writePort(m.now + KB_FALL_CYCLES, KB_PORT_A, kb_level_a(held));
  writePort(m.now + KB_FALL_CYCLES, KB_PORT_C, kb_level_c(held, out_c));
}

/* Watchdog like the AVR's: all pins low, and a new start. */
static bool watchdogFires(void) {
  if (m.now - m.fed < KB_WATCHDOG_CYCLES) {
    return false;
  }
  writePort(m.now, KB_PORT_A, 0);
  writePort(m.now, KB_PORT_C, 0);
  m.rx_full = false;
  m.fed = m.now;
  m.next_tick = m.now + KB_TICK_CYCLES;
  kb_controller_init(KB_FAULT_WATCHDOG);
  return true;
}

static void driveInput(unsigned port, unsigned bit, bool level) {
  if (port == KB_PORT_H && bit == 7) {
    if (level && !m.power_level) {
      m.power_edges++;
    }
    m.power_level = level;
    return;
  }
  if (bit > 7 || (port != KB_PORT_D && port != KB_PORT_L)) {
    return;
  }
  uint8_t* const pins = port == KB_PORT_D ? &m.port_d : &m.port_l;
  const uint8_t before = *pins;
  *pins = (uint8_t)(level ? before | 1U << bit : before & ~(1U << bit));
  if (port != KB_PORT_D || before == *pins) {
    return;
  }
  if (bit == 2) {
    kb_belt_edge((uint8_t)(*pins >> 1) & KB_A, *pins & KB_B, timeNow());
  } else if (bit == 3 && level) {
    kb_belt_mark_edge(timeNow());
  }
}

static uint64_t pendingDrive(void) {
  if (m.drives.read == m.drives.size) {
    m.drives.read = m.drives.size = 0;
    return UINT64_MAX;
  }
  struct kb_buffer look = m.drives;
  return kb_get_uint(&look, 8);
}

static uint64_t pendingByte(void) {
  if (m.rx.read == m.rx.size) {
    m.rx.read = m.rx.size = 0;
    return UINT64_MAX;
  }
  return m.next_byte;
}

/* Runs to `until`. Inputs come before bytes, and bytes before ticks, at the same cycle. */
static void runUntil(uint64_t until) {
  for (;;) {
    const uint64_t drive = pendingDrive();
    const uint64_t byte = pendingByte();
    uint64_t at = drive < byte ? drive : byte;
    at = at < m.next_tick ? at : m.next_tick;
    if (at > until) {
      break;
    }
    m.now = at;
    if (drive == at) {
      kb_get_uint(&m.drives, 8);
      const unsigned port = (unsigned)kb_get_uint(&m.drives, 1);
      const unsigned bit = (unsigned)kb_get_uint(&m.drives, 1);
      driveInput(port, bit, kb_get_uint(&m.drives, 1) != 0);
      continue;
    }
    if (byte == at) {
      m.rx_errors = (uint8_t)(m.rx_errors + (m.rx_full && m.rx_errors < UINT8_MAX ? 1 : 0));
      m.rx_byte = (uint8_t)kb_get_uint(&m.rx, 1);
      m.rx_full = true;
      m.next_byte = at + KB_BYTE_CYCLES;
    } else {
      if (!watchdogFires()) {
        tick();
        m.next_tick += KB_TICK_CYCLES;
      }
    }
    kb_controller_poll();
    kb_controller_poll();
  }
  m.now = until;
}

static void sendBatch(uint64_t until) {
  /* Events are in order of time, and a few of the last tick may lie behind `until`. */
  size_t ready = m.events.size / KB_EVENT_BYTES;
  while (ready > 0) {
    struct kb_buffer look = m.events;
    look.read = (ready - 1) * KB_EVENT_BYTES;
    if (kb_get_uint(&look, 8) <= until) {
      break;
    }
    --ready;
  }
  const bool flooded = m.max_events != 0 && ready > m.max_events;
  struct kb_buffer batch = {0};
  kb_put_uint(&batch, flooded ? KB_PS_FLOODED : KB_PS_REACHED, 1);
  kb_put_uint(&batch, until, 8);
  const size_t sent = flooded ? (size_t)m.max_events : ready;
  kb_put_uint(&batch, sent, 4);
  kb_put_bytes(&batch, m.events.bytes, sent * KB_EVENT_BYTES);
  kb_put_uint(&batch, m.tx.size, 4);
  kb_put_bytes(&batch, m.tx.bytes, m.tx.size);
  kb_put_text(&batch, flooded ? "the firmware made more pin events than allowed" : "");
  kb_write_message(KB_PS_BATCH, &batch);
  kb_buffer_free(&batch);
  m.tx.size = 0;
  const size_t left = m.events.size - ready * KB_EVENT_BYTES;
  if (left != 0) {
    memmove(m.events.bytes, m.events.bytes + ready * KB_EVENT_BYTES, left);
  }
  m.events.size = left;
}

static void refuse(const char* why) {
  struct kb_buffer reply = {0};
  kb_put_text(&reply, why);
  kb_write_message(KB_PS_ERROR, &reply);
  kb_buffer_free(&reply);
}

static bool openImage(struct kb_buffer* request) {
  const uint32_t version = (uint32_t)kb_get_uint(request, 4);
  const uint64_t clock_hz = kb_get_uint(request, 8);
  const uint32_t baud = (uint32_t)kb_get_uint(request, 4);
  m.max_events = kb_get_uint(request, 8);
  kb_skip_text(request);
  kb_skip_text(request);
  if (request->short_read || version != KB_PS_VERSION) {
    refuse("this build speaks another version of the pin-stream protocol");
    return false;
  }
  if ((clock_hz != 0 && clock_hz != KB_CPU_HZ) || (baud != 0 && baud != KB_BAUD)) {
    char why[80];
    snprintf(why, sizeof(why), "this native controller runs at %lu Hz and %lu baud only", KB_CPU_HZ, KB_BAUD);
    refuse(why);
    return false;
  }
  kb_controller_init(KB_OK);
  m.next_tick = KB_TICK_CYCLES;
  struct kb_buffer reply = {0};
  kb_put_uint(&reply, KB_PS_VERSION, 4);
  kb_put_uint(&reply, 1, 8);
  kb_put_uint(&reply, KB_CPU_HZ, 8);
  kb_put_uint(&reply, 0, 4);
  kb_put_text(&reply, "native controller \"" KB_TARGET_NAME "\", core built for the host");
  kb_write_message(KB_PS_HELLO, &reply);
  kb_buffer_free(&reply);
  return true;
}

static void queueDrive(struct kb_buffer* request) {
  const uint64_t at = kb_get_uint(request, 8);
  kb_put_uint(&m.drives, at > m.now ? at : m.now, 8);
  const uint64_t port = kb_get_uint(request, 2);
  const uint64_t bit = kb_get_uint(request, 2);
  kb_put_uint(&m.drives, port > 255 ? 255 : port, 1);
  kb_put_uint(&m.drives, bit > 255 ? 255 : bit, 1);
  kb_put_uint(&m.drives, kb_get_uint(request, 1), 1);
}

int main(void) {
  struct kb_buffer request = {0};
  uint8_t type;
  bool open = false;
  while (kb_read_message(&type, &request)) {
    if (type == KB_PS_QUIT) {
      return 0;
    }
    if (type == KB_PS_OPEN && !open) {
      open = openImage(&request);
      if (!open) {
        return 2;
      }
    } else if (type == KB_PS_DRIVE && open) {
      queueDrive(&request);
    } else if (type == KB_PS_UART && open) {
      if (m.rx.read == m.rx.size && m.next_byte < m.now + KB_BYTE_CYCLES) {
        m.next_byte = m.now + KB_BYTE_CYCLES;
      }
      kb_put_bytes(&m.rx, request.bytes, request.size);
    } else if (type == KB_PS_ADVANCE && open) {
      const uint64_t until = kb_get_uint(&request, 8);
      if (!request.short_read && until > m.now) {
        runUntil(until);
      }
      sendBatch(m.now);
    } else {
      kb_die("a request that does not fit here");
    }
    if (request.short_read) {
      kb_die("a request is shorter than its type needs");
    }
  }
  return 0;
}
