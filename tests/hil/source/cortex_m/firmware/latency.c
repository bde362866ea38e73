/* SPDX-License-Identifier: Apache-2.0 */
/* Cycles by DWT: of an entry (from the store that makes EXTI0 pending), of the way from EXTI0's handler to
 * EXTI1's by tail-chaining, and of the return. */
#include "stm32f103.h"

volatile uint32_t stamps[4];

__attribute__((naked)) void on_exti0(void) {
  __asm__ volatile(
      "ldr r0, =0xE0001004\n ldr r1, =stamps\n ldr r2, [r0]\n str r2, [r1, #0]\n nop\n ldr r2, [r0]\n"
      "str r2, [r1, #4]\n bx lr\n");
}
__attribute__((naked)) void on_exti1(void) {
  __asm__ volatile("ldr r0, =0xE0001004\n ldr r1, =stamps\n ldr r2, [r0]\n str r2, [r1, #8]\n nop\n bx lr\n");
}

int main(void) {
  /* Without wait states, so that the core's own cycles are seen: the clock is HSI's 8 MHz. */
  FLASH_ACR = 0x10;
  RCC_APB2ENR = 0x4E7D;
  DEMCR = 1U << 24;
  DWT_CTRL = 1;
  enable_interrupt(IRQ_EXTI0);
  enable_interrupt(IRQ_EXTI1);
  const uint32_t both = 1U << IRQ_EXTI0 | 1U << IRQ_EXTI1;
  uint32_t before;
  uint32_t after;
  __asm__ volatile("ldr %0, [%2]\n str %3, [%4]\n ldr %1, [%2]\n"
                   : "=&r"(before), "=&r"(after)
                   : "r"(0xE0001004), "r"(both), "r"(0xE000E200)
                   : "memory", "r0", "r1", "r2", "r3");
  USART1_BRR = 32;
  USART1_CR1 = 1U << 13 | 3U << 2;
  say_number(stamps[0] - before);
  say_number(stamps[2] - stamps[1]);
  say_number(after - stamps[2]);
  for (;;) wait_for_interrupt();
}
