/* SPDX-License-Identifier: Apache-2.0 */
/* A ring of 16 bytes is filled by DMA; idle line, half and whole ring make the firmware send what is new, by
 * DMA as well. */
#include "stm32f103.h"

static volatile uint8_t ring[16];
static uint8_t out[16];
static unsigned taken;

static void forward(void) {
  const unsigned end = 16U - DMA_CNDTR(5);
  unsigned count = 0;
  while ((DMA_CCR(4) & 1U) != 0 && DMA_CNDTR(4) != 0) {
  }
  for (; taken != end % 16U; taken = (taken + 1U) % 16U) out[count++] = ring[taken];
  if (count == 0) return;
  DMA_CCR(4) = 0;
  DMA_CNDTR(4) = count;
  DMA_CCR(4) = 0x91;
}

void on_usart1(void) {
  (void)USART1_SR;
  (void)USART1_DR;
  forward();
}

void on_dma5(void) {
  DMA_IFCR = 0xFU << 16;
  forward();
}

int main(void) {
  set_clock();
  set_uart(250000);
  DMA_CPAR(5) = 0x40013804;
  DMA_CMAR(5) = (uint32_t)ring;
  DMA_CNDTR(5) = 16;
  DMA_CCR(5) = 0xA7;
  DMA_CPAR(4) = 0x40013804;
  DMA_CMAR(4) = (uint32_t)out;
  USART1_CR3 = 0xC0;
  USART1_CR1 |= 1U << 4;
  enable_interrupt(IRQ_USART1);
  enable_interrupt(IRQ_DMA5);
  for (;;) wait_for_interrupt();
}
