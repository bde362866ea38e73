/* SPDX-License-Identifier: Apache-2.0 */
/* A controller without an input that counts: the loop on the measured power stays open. */
#include "firmware_under_test/controller/core/power_loop.h"

volatile uint8_t kb_power_counter;

void kb_power_init(void) {}
bool kb_power_configure(const uint8_t* payload, uint8_t length) {
  (void)payload;
  return length == 0;
}
void kb_power_boundary(uint8_t counter) { (void)counter; }
uint8_t kb_power_command(bool lit, uint8_t power) {
  (void)lit;
  return power;
}
uint16_t kb_power_trim(void) { return 1U << 14; }
