/* SPDX-License-Identifier: Apache-2.0 */
#include <util/delay.h>

int main(void) {
  _delay_ms(1);
  __asm__ volatile(".word 0x0001");
  for (;;) {
  }
}
