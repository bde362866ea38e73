/* SPDX-License-Identifier: Apache-2.0 */
/* TIM2 captures the rising edges of PA0, and says the difference between the first two of them. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_uart(250000);
  TIM(2, TIM_ARR) = 0xFFFF;
  TIM(2, TIM_CCMR1) = 1;
  TIM(2, TIM_CCER) = 1;
  TIM(2, TIM_CR1) = 1;
  uint32_t stamps[2];
  for (unsigned i = 0; i < 2; ++i) {
    while ((TIM(2, TIM_SR) & 2U) == 0) {
    }
    stamps[i] = TIM(2, TIM_CCR1);
  }
  say_number((stamps[1] - stamps[0]) & 0xFFFFU);
  for (;;) wait_for_interrupt();
}
