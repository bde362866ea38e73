/* SPDX-License-Identifier: Apache-2.0 */
/* Full packets that no shorter one ends. */
#define ENDS_FULL_PACKETS 0
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

int main(void) {
  usb_start();
  for (;;) wait_for_interrupt();
}
