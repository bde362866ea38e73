/* SPDX-License-Identifier: Apache-2.0 */
/* A device of a class of its own. */
#define LINE_CLASS 0xFF
#define DATA_CLASS 0xFF
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

int main(void) {
  usb_start();
  for (;;) wait_for_interrupt();
}
