/* SPDX-License-Identifier: Apache-2.0 */
/* STM32F103 at 72 MHz. */
#ifndef KERFBENCH_CONTROLLER_HAL_H
#define KERFBENCH_CONTROLLER_HAL_H

#include <stdbool.h>
#include <stdint.h>

#include "stm32f103.h"

extern volatile uint8_t kb_rx_bytes[256];
extern volatile uint8_t kb_rx_end;
extern uint8_t kb_rx_first;
extern volatile uint8_t kb_rx_errors;

static inline uint8_t kb_hal_lock(void) {
  uint32_t saved;
  __asm__ volatile("mrs %0, primask\n cpsid i" : "=r"(saved)::"memory");
  return (uint8_t)saved;
}

static inline void kb_hal_unlock(uint8_t saved) {
  __asm__ volatile("msr primask, %0" ::"r"((uint32_t)saved) : "memory");
}

static inline void kb_hal_barrier(void) { __asm__ volatile("" ::: "memory"); }

/* Each tick has the time to hold pulses. */
static inline void kb_hal_hold_pulses(bool hold) { (void)hold; }

/* PB9, PB10 and PB11: limits and guard. */
static inline uint8_t kb_hal_inputs(void) { return (uint8_t)(GPIOB_IDR >> 9 & 0x07U); }

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

static inline void kb_hal_feed_watchdog(void) { IWDG_KR = 0xAAAA; }

static inline bool kb_hal_tx_ready(void) { return (USART1_SR & 0x80U) != 0; }
static inline void kb_hal_tx(uint8_t byte) { USART1_DR = byte; }

#endif
