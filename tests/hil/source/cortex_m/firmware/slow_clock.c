/* SPDX-License-Identifier: Apache-2.0 */
/* HSI all the time: pulses of 100 cycles of 8 MHz. */
#include "stm32f103.h"

int main(void) {
  RCC_APB2ENR = 4;
  RCC_APB1ENR = 1;
  set_outputs();
  GPIOA_CRL = 0x444444B4 | 0x3;
  GPIOA_CRL = 0x444444B3;
  TIM(2, TIM_ARR) = 99;
  TIM(2, TIM_CCR2) = 30;
  TIM(2, TIM_CCMR1) = 0x6000;
  TIM(2, TIM_CCER) = 0x10;
  TIM(2, TIM_EGR) = 1;
  TIM(2, TIM_CR1) = 1;
  for (;;) {
  }
}
