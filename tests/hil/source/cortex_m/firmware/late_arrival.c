/* SPDX-License-Identifier: Apache-2.0 */
/* TIM3, urgent, pulses PA1 each 1000 cycles; TIM2, not urgent, toggles PA0 each 2000, three cycles before it:
 * the entry of its handler has begun when the other interrupt arrives. */
#include "stm32f103.h"

void on_tim2(void) {
  TIM(2, TIM_SR) = 0;
  GPIOA_ODR ^= 1;
}

void on_tim3(void) {
  GPIOA_BSRR = 2;
  TIM(3, TIM_SR) = 0;
  GPIOA_BSRR = 2U << 16;
}

int main(void) {
  set_clock();
  set_outputs();
  NVIC_IPR(IRQ_TIM2) = 0x80;
  NVIC_IPR(IRQ_TIM3) = 0x10;
  enable_interrupt(IRQ_TIM2);
  enable_interrupt(IRQ_TIM3);
  TIM(2, TIM_ARR) = 1999;
  TIM(3, TIM_ARR) = 999;
  TIM(2, TIM_DIER) = 1;
  TIM(3, TIM_DIER) = 1;
  __asm__ volatile("str %2, [%0]\n str %2, [%1]\n" ::"r"(0x40000000), "r"(0x40000400), "r"(1) : "memory");
  for (;;) wait_for_interrupt();
}
