/* SPDX-License-Identifier: Apache-2.0 */
/* The PLL's factor is 8 instead of 9. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  RCC_CFGR &= ~3U;
  RCC_CR &= ~(1U << 24);
  RCC_CFGR = 6U << 18 | 1U << 16 | 4U << 8;
  RCC_CR |= 1U << 24;
  RCC_CFGR |= 2U;
  for (;;) {
  }
}
