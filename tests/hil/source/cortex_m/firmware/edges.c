/* SPDX-License-Identifier: Apache-2.0 */
/* Edges on PB0 (rising) toggle PA0, and on PB1 (both) PA1. */
#include "stm32f103.h"

void on_exti0(void) {
  EXTI_PR = 1;
  GPIOA_ODR ^= 1;
}

void on_exti1(void) {
  EXTI_PR = 2;
  GPIOA_ODR ^= 2;
}

int main(void) {
  set_clock();
  set_outputs();
  AFIO_EXTICR1 = 0x11;
  EXTI_RTSR = 3;
  EXTI_FTSR = 2;
  EXTI_IMR = 3;
  enable_interrupt(IRQ_EXTI0);
  enable_interrupt(IRQ_EXTI1);
  for (;;) wait_for_interrupt();
}
