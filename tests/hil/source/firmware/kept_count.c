/* SPDX-License-Identifier: Apache-2.0 */
/* Pulses of 20 us whose end is timed by timer 0: the count is written while the clock is stopped. One each
 * ms. */
#include <avr/interrupt.h>
#include <avr/io.h>

ISR(TIMER0_OVF_vect) {
  PORTA = 0;
  TCCR0B = 0;
}

ISR(TIMER1_COMPA_vect) {
  PORTA = 1;
  TCNT0 = (uint8_t)-40;
  TCCR0B = 1 << CS01;
}

int main(void) {
  DDRA = 0xFF;
  TIMSK0 = 1 << TOIE0;
  OCR1A = 15999;
  TIMSK1 = 1 << OCIE1A;
  TCCR1B = (1 << WGM12) | (1 << CS10);
  sei();
  for (;;) {
  }
}
