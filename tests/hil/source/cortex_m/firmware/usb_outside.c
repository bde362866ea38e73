/* SPDX-License-Identifier: Apache-2.0 */
/* A buffer whose last bytes are behind the packet memory. */
#define SEND_BUFFER 0x1F0
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

int main(void) {
  usb_start();
  for (;;) wait_for_interrupt();
}
