/* SPDX-License-Identifier: Apache-2.0 */
/* Puts on port A how many cycles an interrupt came after its timer: by turns out of sleep, which sets bit 7,
 * and out of a loop. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdint.h>

static volatile uint8_t asleep;

ISR(TIMER1_COMPA_vect) {
  const uint8_t late = TCNT1L;
  PORTA = late | (asleep ? 0x80 : 0);
  PORTA = 0;
  asleep = !asleep;
  /* So that the next one meets the loop in another of its instructions. */
  static uint8_t turn;
  for (uint8_t i = turn++ & 15; i != 0; --i) __asm__ volatile("nop");
}

int main(void) {
  DDRA = 0xFF;
  OCR1A = 996;
  TIMSK1 = 1 << OCIE1A;
  TCCR1B = (1 << WGM12) | (1 << CS10);
  set_sleep_mode(SLEEP_MODE_IDLE);
  sei();
  for (;;) {
    if (asleep) sleep_mode();
  }
}
