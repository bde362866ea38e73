/* SPDX-License-Identifier: Apache-2.0 */
/* Two buffers for one endpoint. */
#define DATA_KIND 0x100
#include "usb_serial.h"

static void on_line(char first) { (void)first; }

int main(void) {
  usb_start();
  for (;;) wait_for_interrupt();
}
