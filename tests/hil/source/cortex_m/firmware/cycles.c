/* SPDX-License-Identifier: Apache-2.0 */
/* Cycles that the core takes, by DWT, at no wait states: each sequence lies between two readings of the
 * counter, whose own cost is taken off. */
#include "stm32f103.h"

static volatile uint32_t cell[4];

#define MEASURE(name, ...)                                                             \
  do {                                                                                 \
    uint32_t a, b;                                                                     \
    __asm__ volatile(                                                                  \
        ".balign 8\n nop\n nop\n nop\n nop\n movs r5, #3\n movs r6, #1\n mov r8, %3\n" \
        "ldr %0, [%2]\n nop\n" __VA_ARGS__ "\n ldr %1, [%2]\n"                         \
        : "=&r"(a), "=&r"(b)                                                           \
        : "r"(0xE0001004), "r"(cell)                                                   \
        : "r4", "r5", "r6", "r7", "r8", "r9", "memory", "cc");                         \
    say(name " ");                                                                     \
    say_number(b - a - base);                                                          \
    if (first) base = b - a, first = 0;                                                \
  } while (0)

int main(void) {
  FLASH_ACR = 0x10;
  RCC_APB2ENR = 0x4E7D;
  DEMCR = 1U << 24;
  DWT_CTRL = 1;
  USART1_BRR = 32;
  USART1_CR1 = 1U << 13 | 3U << 2;
  uint32_t base = 0;
  uint32_t first = 1;
  MEASURE("empty", "");
  MEASURE("nop4", "nop\n nop\n nop\n nop\n");
  MEASURE("add_w", "add.w r4, r5, r6, lsl #2\n");
  MEASURE("mul", "mul r4, r5, r6\n");
  MEASURE("mla", "mla r4, r5, r6, r5\n");
  MEASURE("umull", "umull r4, r7, r5, r6\n");
  MEASURE("umlal", "umlal r4, r7, r5, r6\n");
  MEASURE("udiv", "udiv r4, r5, r6\n");
  MEASURE("ldr", "ldr r4, [r8]\n nop\n");
  MEASURE("ldr3", "ldr r4, [r8]\n ldr r5, [r8, #4]\n ldr r6, [r8, #8]\n nop\n");
  MEASURE("ldr_chain", "ldr r4, [r8]\n mov r4, r8\n ldr r4, [r8]\n nop\n");
  MEASURE("str", "str r5, [r8]\n");
  MEASURE("str_reg", "mov r9, #0\n str r5, [r8, r9]\n");
  MEASURE("ldrd", "ldrd r4, r5, [r8]\n nop\n");
  MEASURE("ldm4", "ldmia r8, {r4, r5, r6, r7}\n nop\n");
  MEASURE("stm4", "stmia r8, {r4, r5, r6, r7}\n");
  MEASURE("push_pop", "push {r4, r5}\n pop {r4, r5}\n nop\n");
  MEASURE("pop_pc", "adr r4, 1f\n orr r4, #1\n push {r4}\n pop {pc}\n nop\n .balign 8\n 1:\n");
  MEASURE("ldm_pc", "adr r4, 1f\n orr r4, #1\n push {r3, r4}\n ldmia.w sp!, {r3, pc}\n .balign 8\n 1:\n");
  MEASURE("branch", "b 1f\n nop\n .balign 8\n 1:\n");
  MEASURE("not_taken", "cmp r5, r5\n bne 1f\n nop\n 1:\n");
  MEASURE("taken", "cmp r5, r5\n beq 1f\n nop\n nop\n .balign 8\n 1:\n");
  MEASURE("loop10", "movs r4, #10\n .balign 8\n 1: subs r4, #1\n bne 1b\n");
  MEASURE("it", "cmp r5, r5\n ite eq\n moveq r4, r5\n movne r4, r6\n");
  MEASURE("it_load", "cmp r5, r5\n itt ne\n ldrne r4, [r8]\n ldrne r4, [r8]\n nop\n");
  MEASURE("call", "mov r9, lr\n bl 2f\n b 3f\n .balign 8\n 2: bx lr\n .balign 8\n 3: mov lr, r9\n");
  MEASURE("mrs", "mrs r4, primask\n");
  for (;;) wait_for_interrupt();
}
