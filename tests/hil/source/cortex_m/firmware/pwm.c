/* SPDX-License-Identifier: Apache-2.0 */
/* Outputs of timers alone: edge-aligned PWM on PA6 and PA7 (the second inverted), centre-aligned PWM of TIM1
 * on PA8 with its complement on PB13, a toggle on PB6, and one pulse on PA1. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  GPIOA_CRL = 0xBB3333B3;
  GPIOA_CRH = 0x444444BB;
  GPIOB_CRL = 0x4B444444;
  GPIOB_CRH = 0x44B44444;

  TIM(3, TIM_ARR) = 999;
  TIM(3, TIM_CCR1) = 250;
  TIM(3, TIM_CCR2) = 100;
  TIM(3, TIM_CCMR1) = 0x6868;
  TIM(3, TIM_CCER) = 0x31;
  TIM(3, TIM_EGR) = 1;
  TIM(3, TIM_CR1) = 0x81;

  TIM(1, TIM_ARR) = 500;
  TIM(1, TIM_CCR1) = 100;
  TIM(1, TIM_CCMR1) = 0x68;
  TIM(1, TIM_CCER) = 0x5;
  TIM(1, TIM_BDTR) = 0x8000;
  TIM(1, TIM_EGR) = 1;
  TIM(1, TIM_CR1) = 0xA1;

  TIM(4, TIM_PSC) = 71;
  TIM(4, TIM_ARR) = 9;
  TIM(4, TIM_CCMR1) = 0x30;
  TIM(4, TIM_CCER) = 1;
  TIM(4, TIM_EGR) = 1;
  TIM(4, TIM_CR1) = 1;

  /* One pulse of 300 cycles, 200 after its start. */
  TIM(2, TIM_ARR) = 499;
  TIM(2, TIM_CCR2) = 200;
  TIM(2, TIM_CCMR1) = 0x7000;
  TIM(2, TIM_CCER) = 0x10;
  TIM(2, TIM_EGR) = 1;
  TIM(2, TIM_CR1) = 0x9;
  for (;;) wait_for_interrupt();
}
