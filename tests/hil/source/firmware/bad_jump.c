/* SPDX-License-Identifier: Apache-2.0 */
#include <avr/pgmspace.h>
#include <util/delay.h>

int main(void) {
  _delay_ms(1);
  __asm__ volatile("ldi r30, 0xF0\n ldi r31, 0xFF\n ijmp");
  for (;;) {
  }
}
