/* SPDX-License-Identifier: Apache-2.0 */
#include <avr/interrupt.h>
#include <avr/sleep.h>
#include <util/delay.h>

int main(void) {
  _delay_ms(1);
  cli();
  sleep_enable();
  sleep_cpu();
  for (;;) {
  }
}
