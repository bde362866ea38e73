/* SPDX-License-Identifier: Apache-2.0 */
/* ATmega2560 at 16 MHz. */
#ifndef KERFBENCH_CONTROLLER_HAL_H
#define KERFBENCH_CONTROLLER_HAL_H

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>
#include <stdbool.h>
#include <stdint.h>

extern volatile uint8_t kb_rx_bytes[256];
extern volatile uint8_t kb_rx_end;
extern uint8_t kb_rx_first;
extern volatile uint8_t kb_rx_errors;

static inline uint8_t kb_hal_lock(void) {
  const uint8_t saved = SREG;
  cli();
  return saved;
}

static inline void kb_hal_unlock(uint8_t saved) {
  __asm__ volatile("" ::: "memory");
  SREG = saved;
}

static inline void kb_hal_barrier(void) { __asm__ volatile("" ::: "memory"); }

/* Selects the interrupt of the ticks: compare match A for ticks without pulses that stay active, B for the
 * longer ticks with them. */
static inline void kb_hal_hold_pulses(bool hold) { TIMSK1 = hold ? _BV(OCIE1B) : _BV(OCIE1A); }

static inline uint8_t kb_hal_inputs(void) { return PINL & 0x07U; }

static inline bool kb_hal_rx(uint8_t* byte) {
  if (kb_rx_first == kb_rx_end) {
    return false;
  }
  *byte = kb_rx_bytes[kb_rx_first++];
  return true;
}

/* Bytes that may wait: 8 ms behind the wire; some 2 ms later bytes would be overwritten. */
enum { KB_RX_BACKLOG = 200 };

/* Framing errors and overruns since the last call. */
static inline uint8_t kb_hal_rx_errors(void) {
  const uint8_t saved = kb_hal_lock();
  const uint8_t errors = kb_rx_errors;
  kb_rx_errors = 0;
  kb_hal_unlock(saved);
  const bool behind = (uint8_t)(kb_rx_end - kb_rx_first) > KB_RX_BACKLOG;
  return behind ? (uint8_t)(errors + 1U) : errors;
}

static inline void kb_hal_feed_watchdog(void) { wdt_reset(); }

static inline bool kb_hal_tx_ready(void) { return (UCSR0A & _BV(UDRE0)) != 0; }
static inline void kb_hal_tx(uint8_t byte) { UDR0 = byte; }

#endif
