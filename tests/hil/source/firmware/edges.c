/* SPDX-License-Identifier: Apache-2.0 */
/* PA0 toggles at each rising edge of PD2 (INT2), PA1 at each change of PD3 (INT3). */
#include <avr/interrupt.h>
#include <avr/io.h>

ISR(INT2_vect) { PINA = 1; }
ISR(INT3_vect) { PINA = 2; }

int main(void) {
  DDRA = 3;
  EICRA = (1 << ISC21) | (1 << ISC20) | (1 << ISC30);
  EIMSK = (1 << INT2) | (1 << INT3);
  sei();
  for (;;) {
  }
}
