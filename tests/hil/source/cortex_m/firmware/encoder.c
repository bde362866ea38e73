/* SPDX-License-Identifier: Apache-2.0 */
/* TIM4 counts an encoder on PB6 and PB7 by both, TIM3 one on PA6 and PA7 by TI1 alone; TIM2 counts rising
 * edges of PA0. Any byte asks for the counts. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  TIM(4, TIM_ARR) = 0xFFFF;
  TIM(4, TIM_SMCR) = 3;
  TIM(4, TIM_CR1) = 1;
  TIM(3, TIM_ARR) = 0xFFFF;
  TIM(3, TIM_SMCR) = 2;
  TIM(3, TIM_CR1) = 1;
  TIM(2, TIM_CCMR1) = 1;
  TIM(2, TIM_SMCR) = 0x57;
  TIM(2, TIM_CR1) = 1;
  set_uart(250000);
  for (;;) {
    while ((USART1_SR & 0x20U) == 0) {
    }
    (void)USART1_DR;
    say_number(TIM(4, TIM_CNT));
    say_number(TIM(3, TIM_CNT));
    say_number(TIM(2, TIM_CNT));
  }
}
