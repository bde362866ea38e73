/* SPDX-License-Identifier: Apache-2.0 */
/* Reads a byte only every 200 us, which is five byte times: flow control must hold the line. Answers each
 * byte. */
#include <avr/io.h>
#include <util/delay.h>

int main(void) {
  UBRR0 = 3;
  UCSR0B = (1 << RXEN0) | (1 << TXEN0);
  for (;;) {
    while (!(UCSR0A & (1 << RXC0))) {
    }
    _delay_us(200);
    UDR0 = UDR0;
  }
}
