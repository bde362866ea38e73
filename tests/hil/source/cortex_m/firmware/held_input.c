/* SPDX-License-Identifier: Apache-2.0 */
/* PB8, with a pull-up, is copied to PA0, while PB9 of the same port is written all the time. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_outputs();
  GPIOB_CRH = 0x44444438;
  GPIOB_BSRR = 1U << 8;
  for (;;) {
    GPIOB_BSRR = 1U << 9;
    GPIOA_ODR = GPIOB_IDR >> 8 & 1U;
    GPIOB_BSRR = 1U << 25;
  }
}
