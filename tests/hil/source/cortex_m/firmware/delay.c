/* SPDX-License-Identifier: Apache-2.0 */
/* PA0 toggles after each 1000 turns of a loop that counts in a register, and after a flag of SysTick's, for
 * which a loop waits that changes nothing. */
#include "stm32f103.h"

static volatile uint32_t ticked;

void on_systick(void) { ticked = 1; }

int main(void) {
  set_clock();
  set_outputs();
  for (int i = 0; i < 10; ++i) {
    __asm__ volatile("mov r0, #1000\n .balign 8\n 1: subs r0, #1\n bne 1b\n" ::: "r0", "cc");
    GPIOA_ODR ^= 1;
  }
  SYST_RVR = 71999;
  SYST_CVR = 0;
  SYST_CSR = 7;
  for (;;) {
    while (!ticked) {
    }
    ticked = 0;
    GPIOA_ODR ^= 1;
  }
}
