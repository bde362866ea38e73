/* SPDX-License-Identifier: Apache-2.0 */
/* Each kind of usage fault, with the bits of CFSR that tell it. */
#include "stm32f103.h"

#define SCB_CCR REG(0xE000ED14)

static volatile uint32_t cause;

/* R0 says where to go on. */
__attribute__((used)) static void note(uint32_t* frame) {
  cause = SCB_CFSR;
  SCB_CFSR = cause;
  frame[6] = frame[0];
}
__attribute__((naked)) void on_usage_fault(void) { __asm__ volatile("mov r0, sp\n b note\n"); }

#define PROVOKE(...)                                                                    \
  do {                                                                                  \
    cause = 0;                                                                          \
    __asm__ volatile("adr r0, 1f\n movs r1, #0\n mov r3, sp\n add r3, #2\n" __VA_ARGS__ \
                     "\n .balign 4\n 1:\n" ::                                           \
                         : "r0", "r1", "r2", "r3", "cc", "memory");                     \
    say_number(cause);                                                                  \
  } while (0)

int main(void) {
  set_clock();
  set_uart(250000);
  SCB_SHCSR = 1U << 18;
  PROVOKE("udiv r2, r1, r1");
  PROVOKE("ldr r1, [r3]");
  PROVOKE("ldrd r1, r2, [r3]");
  PROVOKE("udf #0");
  PROVOKE("bx r0"); /* ADR gives an even address. */
  SCB_CCR = 0x218;
  PROVOKE("udiv r2, r1, r1");
  PROVOKE("ldr r1, [r3]");
  for (;;) wait_for_interrupt();
}
