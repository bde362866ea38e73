/* SPDX-License-Identifier: Apache-2.0 */
/* `sbi PINA, 0` toggles one bit, whatever its neighbours are. */
#include <avr/io.h>

int main(void) {
  DDRA = 0xFF;
  PORTA = 0xF0;
  for (;;) {
    __asm__ volatile("sbi %0, 0" ::"I"(_SFR_IO_ADDR(PINA)));
  }
}
