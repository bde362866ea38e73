/* SPDX-License-Identifier: Apache-2.0 */
/* SysTick each 720 cycles toggles PA0. */
#include "stm32f103.h"

void on_systick(void) { GPIOA_ODR ^= 1; }

int main(void) {
  set_clock();
  set_outputs();
  SYST_RVR = 719;
  SYST_CVR = 0;
  SYST_CSR = 7;
  for (;;) {
  }
}
