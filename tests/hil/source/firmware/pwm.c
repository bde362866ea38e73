/* SPDX-License-Identifier: Apache-2.0 */
/* Laser power on OC0A (PB7), 62.5 kHz: 25 % for 1 ms, 75 % for 1 ms, always on for 1 ms, then disconnected.
 * PB6 steps with each phase by a write to the whole port, which must not disturb the PWM. */
#include <avr/io.h>
#include <util/delay.h>

int main(void) {
  DDRB = 0xC0;
  OCR0A = 63;
  TCCR0A = (1 << COM0A1) | (1 << WGM01) | (1 << WGM00);
  TCCR0B = 1 << CS00;
  _delay_ms(1);
  PORTB = 0x40;
  OCR0A = 191;
  _delay_ms(1);
  PORTB = 0x00;
  OCR0A = 255;
  _delay_ms(1);
  PORTB = 0x40;
  TCCR0A = (1 << WGM01) | (1 << WGM00);
  for (;;) {
  }
}
