/* SPDX-License-Identifier: Apache-2.0 */
/* 1000 pulses on PA0 and PA2 at once, 25 kHz, DIR PA1 set first, period written in each interrupt; then 'D'
 * on the UART. */
#include <avr/interrupt.h>
#include <avr/io.h>

static volatile uint16_t left = 1000;

ISR(TIMER1_COMPA_vect) {
  OCR1A = 639;
  if (left == 0) return;
  PORTA |= 0x05;
  --left;
  PORTA &= (uint8_t)~0x05;
}

int main(void) {
  DDRA = 0x07;
  PORTA = 0x02;
  UBRR0 = 3;
  UCSR0B = 1 << TXEN0;
  OCR1A = 639;
  TIMSK1 = 1 << OCIE1A;
  TCCR1B = (1 << WGM12) | (1 << CS10);
  sei();
  while (left != 0) {
  }
  UDR0 = 'D';
  for (;;) {
  }
}
