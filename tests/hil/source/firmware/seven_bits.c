/* SPDX-License-Identifier: Apache-2.0 */
/* Says one byte at 250 000 baud, in frames of seven bits without parity. */
#include <avr/io.h>

int main(void) {
  UBRR0 = 3;
  UCSR0C = 1 << UCSZ01;
  UCSR0B = 1 << TXEN0;
  UDR0 = 'A';
  for (;;) {
  }
}
