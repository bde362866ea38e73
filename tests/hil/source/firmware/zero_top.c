/* SPDX-License-Identifier: Apache-2.0 */
/* Grbl's way to start its step timer: the interrupt is enabled with OCR1A still 0, and the first interrupt
 * sets the period. PB0 toggles in each interrupt, PB1 is high in the first one. */
#include <avr/interrupt.h>
#include <avr/io.h>

ISR(TIMER1_COMPA_vect) {
  OCR1A = 1599;
  PINB = 1 << PINB0;
}

int main(void) {
  DDRB = 1 << DDB0;
  TCCR1A = 0;
  TCCR1B = (1 << WGM12) | (1 << CS10);
  TIMSK1 = 1 << OCIE1A;
  sei();
  for (;;) {
  }
}
