/* SPDX-License-Identifier: Apache-2.0 */
/* Aliases of single bits: a variable in the SRAM, and an output. */
#include "stm32f103.h"

static volatile uint32_t word;

int main(void) {
  set_clock();
  set_outputs();
  set_uart(250000);
  const uint32_t alias = 0x22000000U + ((uint32_t)&word - 0x20000000U) * 32U;
  REG(alias + 4 * 5) = 1;
  REG(alias + 4 * 31) = 3;
  say_number(word);
  say_number(REG(alias + 4 * 5));
  REG(alias + 4 * 5) = 2;
  say_number(word >> 5 & 1U);
  REG(0x42000000U + 0x1080CU * 32U + 4 * 3) = 1; /* GPIOA_ODR, bit 3 */
  REG(0x42000000U + 0x1080CU * 32U + 4 * 3) = 0;
  for (;;) wait_for_interrupt();
}
