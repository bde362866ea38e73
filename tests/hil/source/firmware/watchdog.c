/* SPDX-License-Identifier: Apache-2.0 */
/* Raises PA0 and hangs; the watchdog resets it every 16 ms. */
#include <avr/io.h>
#include <avr/wdt.h>

int main(void) {
  wdt_enable(WDTO_15MS);
  DDRA = 1;
  PORTA = 1;
  for (;;) {
  }
}
