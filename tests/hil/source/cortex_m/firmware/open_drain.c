/* SPDX-License-Identifier: Apache-2.0 */
/* PA0 as open drain: released, pulled low, and what IDR reads of it. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_uart(250000);
  GPIOA_BSRR = 1;
  GPIOA_CRL = 0x44444447;
  say_number(GPIOA_IDR & 1U);
  GPIOA_BRR = 1;
  say_number(GPIOA_IDR & 1U);
  GPIOA_BSRR = 1;
  say_number(GPIOA_IDR & 1U);
  for (;;) wait_for_interrupt();
}
