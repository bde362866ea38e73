/* SPDX-License-Identifier: Apache-2.0 */
/* Devices without a clock read 0 and take no notice; EXTI needs none. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_uart(250000);
  RCC_APB1ENR &= ~1U;
  TIM(2, TIM_ARR) = 77;
  say_number(TIM(2, TIM_ARR));
  REG(0x40005400) = 1; /* I2C1, which is off */
  say_number(REG(0x40005400));
  RCC_APB1ENR |= 1U;
  say_number(TIM(2, TIM_ARR));
  RCC_APB2ENR &= ~1U;
  EXTI_RTSR = 5;
  say_number(EXTI_RTSR);
  for (;;) wait_for_interrupt();
}
