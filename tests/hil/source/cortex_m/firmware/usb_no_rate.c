/* SPDX-License-Identifier: Apache-2.0 */
/* A line that knows of no rate and no control lines: PSTN 1.2 lets it refuse both. */
#define STALLED_REQUEST 0x20
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

int main(void) {
  usb_start();
  for (;;) wait_for_interrupt();
}
