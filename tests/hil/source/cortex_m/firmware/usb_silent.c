/* SPDX-License-Identifier: Apache-2.0 */
/* A device that is on the bus and never serves it. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  RCC_APB1ENR |= 1U << 23;
  USB_CNTR = 1;
  USB_CNTR = 0;
  for (;;) {
  }
}
