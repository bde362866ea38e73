/* SPDX-License-Identifier: Apache-2.0 */
/* A buffer of 32 bytes for packets that may have 64. */
#define RECEIVE_BLOCKS 0x8000
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

int main(void) {
  usb_start();
  for (;;) wait_for_interrupt();
}
