/* SPDX-License-Identifier: Apache-2.0 */
/* The converter, with its clock on. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  RCC_APB2ENR |= 1U << 9;
  REG(0x40012408) = 1;
  for (;;) {
  }
}
