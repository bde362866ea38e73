/* SPDX-License-Identifier: Apache-2.0 */
#include <stdint.h>
#include <util/delay.h>

int main(void) {
  _delay_ms(1);
  *(volatile uint8_t*)0xF000 = 1;
  for (;;) {
  }
}
