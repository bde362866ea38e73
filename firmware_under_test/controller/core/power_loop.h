/* SPDX-License-Identifier: Apache-2.0 */
/* Loop on the measured power (Wang, Li, Chen 2010, figure 3; planner/power/loop.h), in whole numbers.
 *
 * A power meter toggles a pin for each quantum of energy; the HAL counts the rising edges. The energy that a
 * power byte should give in a period is a table that the host sends, the curve of the laser (g). With the
 * trim t, P_out the power in the program and P_f the measured one,
 *
 *     t <- t + gain (P_out - P_f) / P_out,   u = g^-1(t P_out),
 *
 * which is the paper's P(k+1) = P(k) + gain (P_out - P_f) in shares of P_out: a tube with 5 % too little
 * power has that at every power, so a trim found at one speed holds on the ramps, where a sum in watts would
 * not.
 *
 * Each measurement is compared with the power that was wanted when its energy was emitted, `delay` ticks
 * before. Where the laser was dark then or within two periods before, nothing is learnt. A meter that is
 * silent for 4 lit periods counts as none: the loop opens (t = 1) until the meter sends edges again. t stays
 * within 1/2 and 2, u within the laser's least and most: below its least power a tube does not burn steadily,
 * so a slow beam gets the least power and cuts deeper there. */
#ifndef KERFBENCH_CONTROLLER_POWER_LOOP_H
#define KERFBENCH_CONTROLLER_POWER_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware_under_test/controller/protocol.h"

/* Rising edges of the meter up to the last boundary, modulo 256; the HAL writes it where it calls
 * kb_tick_boundary(). One byte, since two would take the tick interrupt beyond 300 cycles. */
extern volatile uint8_t kb_power_counter;

void kb_power_init(void);
/* Reads KB_POWER's payload; empty: no loop. False for values out of range. */
bool kb_power_configure(const uint8_t* payload, uint8_t length);
/* Begins the period that was offered last; called at each boundary. */
void kb_power_boundary(uint8_t counter);
/* Power byte for the period in preparation, which is to burn with the program's `power`. */
uint8_t kb_power_command(bool lit, uint8_t power);
/* Trim t, 1/16384. */
uint16_t kb_power_trim(void);

#endif
