/* SPDX-License-Identifier: Apache-2.0 */
/* A serial line on USB beside a USART at another rate, which says something at the start and with each line.
 */
#include "usb_serial.h"

static void on_line(char first) {
  (void)first;
  USART1_DR = 'u';
}

int main(void) {
  usb_start();
  set_uart(9600);
  USART1_DR = 'u';
  for (;;) wait_for_interrupt();
}
