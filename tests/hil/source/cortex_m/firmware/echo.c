/* SPDX-License-Identifier: Apache-2.0 */
/* Each byte comes back increased by one, from the receiver's interrupt; PA0 toggles with it. */
#include "stm32f103.h"

void on_usart1(void) {
  const uint32_t byte = USART1_DR;
  GPIOA_ODR ^= 1;
  USART1_DR = (byte + 1U) & 0xFFU;
}

int main(void) {
  set_clock();
  set_outputs();
  set_uart(250000);
  USART1_CR1 |= 1U << 5;
  enable_interrupt(IRQ_USART1);
  for (;;) wait_for_interrupt();
}
