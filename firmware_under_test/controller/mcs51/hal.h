/* SPDX-License-Identifier: Apache-2.0 */
/* STC15W4K32S4 at 24 MHz, compiled by SDCC. */
#ifndef KERFBENCH_CONTROLLER_HAL_H
#define KERFBENCH_CONTROLLER_HAL_H

#include <8051.h>
#include <stdbool.h>
#include <stdint.h>

__sfr __at(0x8E) kb_auxr;
__sfr __at(0xAF) kb_ie2;
__sfr __at(0xD6) kb_t2h;
__sfr __at(0xD7) kb_t2l;
__sfr __at(0x93) kb_p0m1;
__sfr __at(0x91) kb_p1m1;
__sfr __at(0x92) kb_p1m0;
__sfr __at(0x95) kb_p2m1;
__sfr __at(0xB1) kb_p3m1;
__sfr __at(0x96) kb_p2m0;

enum { KB_RX_SIZE = 128, KB_RX_BACKLOG = 100 };

extern volatile __xdata uint8_t kb_rx_bytes[KB_RX_SIZE];
extern volatile __data uint8_t kb_rx_end;
extern __data uint8_t kb_rx_first;
extern volatile __bit kb_tx_free;

static inline uint8_t kb_hal_lock(void) {
  const uint8_t saved = IE;
  EA = 0;
  return saved;
}

static inline void kb_hal_unlock(uint8_t saved) {
  if (saved & 0x80U) {
    EA = 1;
  }
}

static inline void kb_hal_barrier(void) {}

extern volatile __bit kb_has_levels;

/* A configuration gives the levels between pulses. Until the first one the pins of the axes stay high, as the
 * reset has left them, so that drives that step by falling edges see none. Pulses that stay active over
 * ticks are not supported: a tick has no time for them. */
static inline void kb_hal_hold_pulses(bool hold) {
  (void)hold;
  kb_has_levels = 1;
}

static inline uint8_t kb_hal_inputs(void) { return P0 & 0x07U; }

static inline bool kb_hal_rx(uint8_t* byte) {
  if (kb_rx_first == kb_rx_end) {
    return false;
  }
  *byte = kb_rx_bytes[kb_rx_first];
  kb_rx_first = (uint8_t)((kb_rx_first + 1U) & (KB_RX_SIZE - 1U));
  return true;
}

/* The serial port has no flags of framing errors or overruns: only bytes that wait too long are known. */
static inline uint8_t kb_hal_rx_errors(void) {
  return ((uint8_t)(kb_rx_end - kb_rx_first) & (KB_RX_SIZE - 1U)) > KB_RX_BACKLOG ? 1 : 0;
}

static inline void kb_hal_feed_watchdog(void) {}

static inline bool kb_hal_tx_ready(void) { return kb_tx_free; }
static inline void kb_hal_tx(uint8_t byte) {
  kb_tx_free = 0;
  SBUF = byte;
}

#endif
