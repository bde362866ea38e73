/* SPDX-License-Identifier: Apache-2.0 */
/* Says the first four bytes of its EEPROM and the last one, in hex, at 250 000 baud. */
#include <avr/eeprom.h>
#include <avr/io.h>

static void put(char c) {
  while (!(UCSR0A & (1 << UDRE0))) {
  }
  UDR0 = (uint8_t)c;
}

static void say(const uint8_t* place) {
  static const char digits[] = "0123456789abcdef";
  const uint8_t value = eeprom_read_byte(place);
  put(digits[value >> 4]);
  put(digits[value & 15]);
}

int main(void) {
  UBRR0 = 3;
  UCSR0B = 1 << TXEN0;
  for (uint8_t i = 0; i < 4; ++i) say((const uint8_t*)(uintptr_t)i);
  say((const uint8_t*)E2END);
  for (;;) {
  }
}
