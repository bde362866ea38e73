/* SPDX-License-Identifier: Apache-2.0 */
#include "fake_machine.h"

#include <math.h>
#include <string.h>

#include "firmware_under_test/controller/core/belt.h"
#include "firmware_under_test/controller/core/controller.h"
#include "firmware_under_test/controller/core/engine.h"
#include "firmware_under_test/controller/core/frame.h"
#include "firmware_under_test/controller/core/program.h"
#include "firmware_under_test/controller/core/queue.h"
#include "hal.h"

struct fake_machine fake;
static uint8_t rx_byte;
static bool rx_full;
static unsigned rx_cycles, tx_cycles;

uint8_t kb_hal_inputs(void) { return fake.inputs; }
bool kb_hal_rx(uint8_t* byte) {
  const bool full = rx_full;
  *byte = rx_byte;
  rx_full = false;
  return full;
}
uint8_t kb_hal_rx_errors(void) {
  const uint8_t errors = fake.rx_errors;
  fake.rx_errors = 0;
  return errors;
}
void kb_hal_feed_watchdog(void) { fake.fed++; }
bool kb_hal_tx_ready(void) { return tx_cycles >= 640; }
void kb_hal_tx(uint8_t byte) {
  tx_cycles = 0;
  if (fake.to_host != NULL) {
    fake.to_host(fake.context, byte);
  }
}

void fakeReset(void) {
  memset(&fake, 0, sizeof(fake));
  fake.inputs = KB_IN_INTERLOCK;
  fake.next_mark_count = INFINITY;
  rx_full = false;
  rx_cycles = tx_cycles = 0;
  kb_controller_init(KB_OK);
}

/* Moves the belt through one tick in four parts, with edges at a quarter of a tick. */
static void moveBelt(void) {
  for (unsigned part = 0; part < 4; ++part) {
    const double before = fake.belt_count;
    fake.belt_count += fake.belt_counts_per_tick / 4;
    const uint16_t now = (uint16_t)((fake.tick * 400U + part * 100U + 100U) / 64U);
    const double edge_before = floor(before / 2);
    const double edge = floor(fake.belt_count / 2);
    if (edge != edge_before) {
      const bool forwards = edge > edge_before;
      const bool a = fmod(fabs(edge), 2.0) == 0.0;
      const bool b = forwards ? !a : a;
      if (!fake.a_lost) {
        kb_belt_edge(a ? KB_A : 0, !fake.b_lost && b ? KB_B : 0, now);
      }
    }
    if (before < fake.next_mark_count && fake.belt_count >= fake.next_mark_count) {
      kb_belt_mark_edge(now);
      ++fake.marks;
      fake.next_mark_count += fake.mark_pitch_counts > 0 ? fake.mark_pitch_counts : INFINITY;
    }
  }
}

void fakeTick(void) {
  moveBelt();
  fake.tick++;
  fake.last.first_a = kb_engine.out_a;
  fake.last.first_c = kb_engine.out_c;
  fake.last.low_a = kb_level_a(kb_engine.held);
  fake.last.low_c = kb_level_c(kb_engine.held, kb_engine.out_c);
  if (kb_tick_begins_period()) {
    kb_tick_boundary((uint16_t)(fake.tick * 400U / 64U));
  }
  kb_tick_compute(fake.inputs, true);
  fake.last.dir_a = kb_engine.idle_a;
  fake.last.dir_c = kb_engine.idle_c;
  tx_cycles += 400;
  rx_cycles += 400;
  if (rx_cycles >= 640 && fake.from_host != NULL && fake.from_host(fake.context, &rx_byte)) {
    rx_full = true;
    rx_cycles -= 640;
  }
  rx_cycles = rx_cycles > 1280 ? 1280 : rx_cycles;
  kb_controller_poll();
  kb_controller_poll();
}

void fakeWatchdogReset(void) { kb_controller_init(KB_FAULT_WATCHDOG); }
void fakeEdge(bool a, bool b) {
  kb_belt_edge(a ? KB_A : 0, b ? KB_B : 0, (uint16_t)(fake.tick * 400U / 64U));
}
int32_t fakePosition(int axis) { return kb_program_position((uint8_t)axis); }
int32_t fakeBeltAhead256(uint8_t periods) { return kb_belt_ahead(periods); }
uint16_t fakeQueueFree(void) { return kb_queue_free(); }
void fakeJobCheck(unsigned* a, unsigned* b) {
  *a = kb_job_check.a;
  *b = kb_job_check.b;
}
uint16_t fakeCrc(const uint8_t* bytes, int size) {
  uint16_t crc = 0xFFFF;
  for (int i = 0; i < size; ++i) {
    crc = kb_crc16(crc, bytes[i]);
  }
  return crc;
}
