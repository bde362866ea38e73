/* SPDX-License-Identifier: Apache-2.0 */
/* Nothing more, with interrupts off. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  __asm__ volatile("cpsid i");
  for (;;) {
  }
}
