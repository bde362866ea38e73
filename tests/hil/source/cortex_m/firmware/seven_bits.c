/* SPDX-License-Identifier: Apache-2.0 */
/* Nine bits and two stops in a frame. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_uart(250000);
  USART1_CR1 |= 1U << 12;
  USART1_CR2 = 2U << 12;
  say("x");
  for (;;) wait_for_interrupt();
}
