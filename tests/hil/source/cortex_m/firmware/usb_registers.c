/* SPDX-License-Identifier: Apache-2.0 */
/* What writing to registers and packet memory of the USB leaves there, said by the USART. */
#include "stm32f103.h"

static uint32_t seen[12];

static void write_and_look(void) {
  seen[0] = USB_CNTR;
  USB_EP(3) = 0xF7F3; /* under reset nothing stays */
  seen[1] = USB_EP(3);
  USB_CNTR = 0;
  USB_EP(3) = 0x3633; /* interrupt endpoint 3: both states VALID */
  seen[2] = USB_EP(3);
  USB_EP(3) = 0xB6A3; /* toggles the states to DISABLED and STALL, and sets no flag */
  seen[3] = USB_EP(3);
  USB_EP(3) = 0x4643; /* toggles the packets' numbers */
  seen[4] = USB_EP(3);
  USB_MEMORY(0x1FE) = 0x12345678; /* a half-word is all that there is */
  seen[5] = REG(0x400063FC);
  USB_MEMORY(0x10) = 0xABCD;
  seen[6] = *(volatile uint16_t*)0x40006020 + 0x10000U * *(volatile uint16_t*)0x40006022;
  USB_BTABLE = 0xFFFF;
  seen[7] = USB_BTABLE;
  USB_CNTR = 1; /* a forced reset is told as one of the bus */
  seen[8] = USB_ISTR;
  seen[9] = USB_EP(3);
  USB_ISTR = 0xFFFF;
  seen[10] = USB_ISTR;
  USB_ISTR = 0;
  seen[11] = USB_ISTR;
  USB_CNTR = 3;
}

int main(void) {
  set_clock();
  RCC_APB1ENR |= 1U << 23;
  set_uart(250000);
  write_and_look();
  for (unsigned i = 0; i < 12; ++i) say_number(seen[i]);
  for (;;) {
  }
}
