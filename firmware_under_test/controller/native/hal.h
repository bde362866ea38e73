/* SPDX-License-Identifier: Apache-2.0 */
/* The core on a computer: the program that links it provides these functions. One thread; interrupts are
 * calls between polls. */
#ifndef KERFBENCH_CONTROLLER_HAL_H
#define KERFBENCH_CONTROLLER_HAL_H

#include <stdbool.h>
#include <stdint.h>

static inline uint8_t kb_hal_lock(void) { return 0; }
static inline void kb_hal_unlock(uint8_t saved) { (void)saved; }
static inline void kb_hal_barrier(void) {}
static inline void kb_hal_hold_pulses(bool hold) { (void)hold; }

#ifdef __cplusplus
extern "C" {
#endif
uint8_t kb_hal_inputs(void);
bool kb_hal_rx(uint8_t* byte);
/* Number of framing errors and overruns since the last call. */
uint8_t kb_hal_rx_errors(void);
void kb_hal_feed_watchdog(void);
bool kb_hal_tx_ready(void);
void kb_hal_tx(uint8_t byte);
#ifdef __cplusplus
}
#endif

#endif
