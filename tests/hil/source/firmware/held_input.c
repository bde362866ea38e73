/* SPDX-License-Identifier: Apache-2.0 */
/* PL0 is an input with pull-up next to an output that toggles; PA0 shows what PL0 reads. */
#include <avr/io.h>

int main(void) {
  DDRA = 1;
  DDRL = 0x80;
  PORTL = 0x01;
  for (;;) {
    PORTL ^= 0x80;
    if (PINL & 1) {
      PORTA = 1;
    } else {
      PORTA = 0;
    }
  }
}
