/* SPDX-License-Identifier: Apache-2.0 */
/* TIM1 with a repetition counter of 4: an update each fifth period of 1000 cycles toggles PA0. */
#include "stm32f103.h"

void on_tim1_up(void) {
  TIM(1, TIM_SR) = 0;
  GPIOA_ODR ^= 1;
}

int main(void) {
  set_clock();
  set_outputs();
  TIM(1, TIM_ARR) = 999;
  TIM(1, TIM_RCR) = 4;
  TIM(1, TIM_EGR) = 1;
  TIM(1, TIM_SR) = 0;
  TIM(1, TIM_DIER) = 1;
  enable_interrupt(IRQ_TIM1_UP);
  TIM(1, TIM_CR1) = 1;
  for (;;) wait_for_interrupt();
}
