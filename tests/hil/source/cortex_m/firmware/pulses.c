/* SPDX-License-Identifier: Apache-2.0 */
/* Timer 2 makes an update each 720 cycles; its interrupt pulses PA0 a thousand times and stops. */
#include "stm32f103.h"

static volatile uint32_t left = 1000;

void on_tim2(void) {
  TIM(2, TIM_SR) = 0;
  GPIOA_BSRR = 1;
  GPIOA_BSRR = 1U << 16;
  if (--left == 0) TIM(2, TIM_CR1) = 0;
}

int main(void) {
  set_clock();
  set_outputs();
  TIM(2, TIM_ARR) = 719;
  TIM(2, TIM_DIER) = 1;
  enable_interrupt(IRQ_TIM2);
  TIM(2, TIM_CR1) = 1;
  for (;;) wait_for_interrupt();
}
