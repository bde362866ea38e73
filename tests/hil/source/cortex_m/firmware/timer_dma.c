/* SPDX-License-Identifier: Apache-2.0 */
/* Updates of TIM2 let DMA write a pattern to GPIOA_BSRR: pulses without the core. */
#include "stm32f103.h"

static const uint32_t kPattern[4] = {1, 2, 1U << 16, 2U << 16};

int main(void) {
  set_clock();
  set_outputs();
  DMA_CPAR(2) = 0x40010810;
  DMA_CMAR(2) = (uint32_t)kPattern;
  DMA_CNDTR(2) = 4;
  DMA_CCR(2) = 0xAB1 & ~2U;
  TIM(2, TIM_ARR) = 359;
  TIM(2, TIM_DIER) = 0x100;
  TIM(2, TIM_CR1) = 1;
  for (;;) wait_for_interrupt();
}
