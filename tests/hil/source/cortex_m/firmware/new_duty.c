/* SPDX-License-Identifier: Apache-2.0 */
/* PWM on PA6 whose duty is changed in the middle of a period, with preload: 250, 500, 0 and 1000 of 1000. */
#include "stm32f103.h"

void on_tim3(void) {
  static uint32_t periods;
  TIM(3, TIM_SR) = 0;
  ++periods;
  if (periods == 10) TIM(3, TIM_CCR1) = 500;
  if (periods == 20) TIM(3, TIM_CCR1) = 0;
  if (periods == 30) TIM(3, TIM_CCR1) = 1000;
  if (periods == 40) TIM(3, TIM_CCR1) = 250;
  if (periods == 50) TIM(3, TIM_CR1) = 0x80;
}

int main(void) {
  set_clock();
  GPIOA_CRL = 0x4B444444;
  TIM(3, TIM_ARR) = 999;
  TIM(3, TIM_CCR1) = 250;
  TIM(3, TIM_CCMR1) = 0x68;
  TIM(3, TIM_CCER) = 1;
  TIM(3, TIM_EGR) = 1;
  TIM(3, TIM_SR) = 0;
  TIM(3, TIM_DIER) = 1;
  enable_interrupt(IRQ_TIM3);
  TIM(3, TIM_CR1) = 0x81;
  for (;;) wait_for_interrupt();
}
