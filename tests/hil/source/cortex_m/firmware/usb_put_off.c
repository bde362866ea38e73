/* SPDX-License-Identifier: Apache-2.0 */
/* A device that never has its descriptors ready. */
#define UNANSWERED_REQUEST 6
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

int main(void) {
  usb_start();
  for (;;) wait_for_interrupt();
}
