/* SPDX-License-Identifier: Apache-2.0 */
/* The core on an STC15W4K32S4: timer 0 gives the ticks, timer 1 the time of belt edges, timer 2 the rate of
 * the serial port. Port 1 has PUL and DIR of the four axes of the head, port 2 feed and laser, port 0 limits
 * and interlock, INT0 and P3.4 the encoder, INT1 the print mark. Nothing counts a power meter. */
#include "firmware_under_test/controller/core/belt.h"
#include "firmware_under_test/controller/core/controller.h"
#include "firmware_under_test/controller/core/engine.h"
#include "firmware_under_test/controller/core/power_loop.h"
#include "hal.h"

volatile __xdata uint8_t kb_rx_bytes[KB_RX_SIZE];
volatile __data uint8_t kb_rx_end;
__data uint8_t kb_rx_first;
volatile __bit kb_tx_free = 1;
volatile __bit kb_has_levels;

/* Timer 1 counts on while it is read: low byte between two equal high ones. */
static inline uint16_t now(void) {
  uint8_t high;
  uint8_t low;
  do {
    high = TH1;
    low = TL1;
  } while (high != TH1);
  return (uint16_t)((uint16_t)high << 8 | low);
}

/* A reset leaves P2.2 and P2.3, those of the laser, as inputs that a resistor pulls down, and pins of the
 * axes high: the laser's are driven low before the start-up code clears the RAM. */
unsigned char _sdcc_external_startup(void) {
  P2 = (uint8_t) ~(KB_LASER_GATE | KB_LASER_PWM);
  kb_p2m1 = 0;
  kb_p2m0 = KB_FEED_PUL | KB_FEED_DIR | KB_LASER_GATE | KB_LASER_PWM;
  kb_p1m1 = 0;
  kb_p1m0 = 0xFF;
  kb_p0m1 = 0x07; /* switches, encoder and mark: inputs that the board pulls down */
  kb_p3m1 = 0x1C;
  return 0;
}

#ifdef KB_DEFECT_DIR_LATE
static uint8_t shown_dirs;

/* Defect: DIR is written with the step that needs it, and 2 us after its PUL. */
static void writeAWithLateDir(void) {
  const uint8_t pulses = kb_engine.out_a & KB_PUL_A;
  const uint8_t stepping_dirs = (uint8_t)((uint8_t)((kb_engine.out_a ^ kb_engine.idle_a) & KB_PUL_A) << 1);
  uint8_t wait = 12;
  P1 = pulses | shown_dirs;
  do {
  } while (--wait);
  shown_dirs = (uint8_t)((shown_dirs & (uint8_t)~stepping_dirs) | (kb_engine.out_a & stepping_dirs));
  P1 = pulses | shown_dirs;
}
#endif

/* Levels of port 2 as guard and limits permit them now: what a tick has computed comes out a tick later, and
 * two ticks after the guard was read the laser would have been on for 0.2 ms. Both ends of a tick's interrupt
 * look, so that an open guard darkens the laser within less than a tick. */
static inline uint8_t permitted(uint8_t out_c) {
  if ((P0 & (uint8_t)(KB_IN_INTERLOCK | KB_IN_LIMITS)) != KB_IN_INTERLOCK) {
    return out_c & (uint8_t) ~(KB_LASER_GATE | KB_LASER_PWM);
  }
  return out_c;
}

void tick(void) __interrupt(1) {
  const uint8_t inputs = P0;
  const uint8_t out_c = kb_engine.out_c;
#ifdef KB_DEFECT_PULSES_LOST
  /* Defect: "the UART must not overrun", so a tick gives way to a waiting byte, and its steps are gone. */
  if (RI) {
    kb_engine.out_a = kb_engine.idle_a;
  }
#endif
  if (kb_has_levels) {
#ifdef KB_DEFECT_DIR_LATE
    writeAWithLateDir();
#else
    P1 = kb_engine.out_a;
#endif
    P2 = permitted(out_c) | 0xF0U;
  }
  if (kb_tick_begins_period()) {
    kb_tick_boundary(now());
  }
  kb_tick_compute(inputs, false);
  if (kb_has_levels) {
#ifdef KB_DEFECT_DIR_LATE
    P1 = (uint8_t)((kb_engine.idle_a & KB_PUL_A) | shown_dirs);
#else
    P1 = kb_engine.idle_a;
#endif
    P2 = (uint8_t)(permitted(out_c & (uint8_t) ~(KB_FEED_PUL | KB_FEED_DIR)) | kb_engine.idle_c | 0xF0U);
  }
}

void encoder(void) __interrupt(0) {
  const uint8_t pins = P3;
  kb_belt_edge((pins & 0x04U) ? KB_A : 0, (pins & 0x10U) ? KB_B : 0, now());
}

/* Both edges come; a mark is the rising one. */
void mark(void) __interrupt(2) {
  if (P3_3) {
    kb_belt_mark_edge(now());
  }
}

void serial(void) __interrupt(4) {
  if (TI) {
    TI = 0;
    kb_tx_free = 1;
  }
  if (RI) {
    RI = 0;
    kb_rx_bytes[kb_rx_end] = SBUF;
    kb_rx_end = (uint8_t)((kb_rx_end + 1U) & (KB_RX_SIZE - 1U));
  }
}

void main(void) {
  kb_controller_init(KB_OK);
  kb_auxr = 0x80U | 0x10U | 0x04U | 0x01U; /* timer 0 and timer 2 count clocks; timer 2 runs, for the UART */
  kb_t2h = (uint8_t)((65536UL - KB_CPU_HZ / 4UL / KB_BAUD) >> 8);
  kb_t2l = (uint8_t)(65536UL - KB_CPU_HZ / 4UL / KB_BAUD);
  SCON = 0x50;
  TMOD = 0x00; /* 16 bits with reload */
  TL0 = (uint8_t)(65536UL - KB_TICK_CYCLES);
  TH0 = (uint8_t)((65536UL - KB_TICK_CYCLES) >> 8);
  IP = 0x02; /* the tick goes first */
  TR0 = 1;
  TR1 = 1;
  IE = 0x97; /* EA, ES, EX1, ET0, EX0 */
  for (;;) {
    kb_controller_poll();
  }
}
