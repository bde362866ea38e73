/* SPDX-License-Identifier: Apache-2.0 */
/* The watchdog of 10 ms is fed ten times, each 5 ms, and then no more. PA0 is high while the firmware runs;
 * after the watchdog's reset it says so. */
#include "stm32f103.h"

static void wait_5_ms(void) {
  SYST_RVR = 359999;
  SYST_CVR = 0;
  SYST_CSR = 5;
  while ((SYST_CSR & (1U << 16)) == 0) {
  }
}

int main(void) {
  set_clock();
  set_outputs();
  if ((RCC_CSR & (1U << 29)) != 0) {
    set_uart(250000);
    say("watchdog\n");
    for (;;) wait_for_interrupt();
  }
  GPIOA_BSRR = 1;
  IWDG_KR = 0x5555;
  IWDG_PR = 0;
  IWDG_RLR = 99;
  IWDG_KR = 0xCCCC;
  for (int i = 0; i < 10; ++i) {
    IWDG_KR = 0xAAAA;
    wait_5_ms();
  }
  for (;;) {
  }
}
