/* SPDX-License-Identifier: Apache-2.0 */
/* A USB device that is no serial line, beside a USART that gives back what it gets. */
#define LINE_CLASS 0xFF
#define DATA_CLASS 0xFF
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

void on_usart1(void) { USART1_DR = USART1_DR; }

int main(void) {
  usb_start();
  set_uart(250000);
  USART1_CR1 |= 1U << 5;
  enable_interrupt(IRQ_USART1);
  for (;;) wait_for_interrupt();
}
