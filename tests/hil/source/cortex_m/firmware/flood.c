/* SPDX-License-Identifier: Apache-2.0 */
/* Edges as fast as they go. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_outputs();
  for (;;) {
    GPIOA_BSRR = 1;
    GPIOA_BSRR = 1U << 16;
  }
}
