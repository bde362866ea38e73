/* SPDX-License-Identifier: Apache-2.0 */
/* Sends back each byte plus one, 250 000 baud; PA0 toggles with each byte received. */
#include <avr/interrupt.h>
#include <avr/io.h>

ISR(USART0_RX_vect) {
  PINA = 1;
  UDR0 = (uint8_t)(UDR0 + 1);
}

int main(void) {
  DDRA = 1;
  UBRR0 = 7;
  UCSR0A = 1 << U2X0;
  UCSR0B = (1 << RXEN0) | (1 << TXEN0) | (1 << RXCIE0);
  sei();
  for (;;) {
  }
}
