/* SPDX-License-Identifier: Apache-2.0 */
/* Code that the firmware copies into the SRAM, runs, and changes. */
#include "stm32f103.h"

static uint16_t code[2] __attribute__((aligned(4)));

int main(void) {
  set_clock();
  set_uart(250000);
  uint32_t (*const run)(void) = (uint32_t(*)(void))((uint32_t)code | 1U);
  code[1] = 0x4770; /* bx lr */
  for (uint16_t i = 1; i <= 3; ++i) {
    code[0] = (uint16_t)(0x2000U + i); /* movs r0, #i */
    __asm__ volatile("dsb\n isb" ::: "memory");
    say_number(run());
  }
  for (;;) wait_for_interrupt();
}
