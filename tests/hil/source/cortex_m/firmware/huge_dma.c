/* SPDX-License-Identifier: Apache-2.0 */
/* Seven channels copy as much as they can, over everything; the last one over the SRAM's end. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_uart(250000);
  for (unsigned i = 1; i <= 7; ++i) {
    DMA_CPAR(i) = 0x08000000;
    DMA_CMAR(i) = i == 7 ? 0x20004800 : 0x20001000;
    DMA_CNDTR(i) = i == 7 ? 0xFFFF : 0x800;
    DMA_CCR(i) = 0x4AC1;
  }
  while ((DMA_ISR & 0x0A000000U) == 0) {
  }
  say_number(DMA_ISR >> 24 & 0xFU);
  say_number(DMA_CCR(7) & 1U);
  for (;;) wait_for_interrupt();
}
