/* SPDX-License-Identifier: Apache-2.0 */
/* Sleeps between interrupts of a 1 kHz timer; PA0 toggles in each. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

ISR(TIMER1_COMPA_vect) { PINA = 1; }

int main(void) {
  DDRA = 1;
  OCR1A = 15999;
  TIMSK1 = 1 << OCIE1A;
  TCCR1B = (1 << WGM12) | (1 << CS10);
  set_sleep_mode(SLEEP_MODE_IDLE);
  sei();
  for (;;) sleep_mode();
}
