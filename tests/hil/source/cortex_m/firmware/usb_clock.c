/* SPDX-License-Identifier: Apache-2.0 */
/* The PLL's 72 MHz for the USB, without the divider of 1.5. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  RCC_CFGR |= 1U << 22;
  RCC_APB1ENR |= 1U << 23;
  USB_CNTR = 1;
  USB_CNTR = 0;
  for (;;) {
  }
}
