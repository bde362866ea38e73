/* SPDX-License-Identifier: Apache-2.0 */
/* Leaves the bus after a line: for 20 ms where that begins with r, for good where it begins with g. */
#include "usb_serial.h"

static volatile char leave;

static void on_line(char first) {
  if (first == 'r' || first == 'g') leave = first;
}

int main(void) {
  usb_start();
  for (;;) {
    if (leave == 0) continue;
    for (volatile int i = 0; i < 40000; ++i) {
    }
    USB_CNTR = FRES | PDWN;
    for (volatile int i = 0; i < 200000; ++i) {
    }
    if (leave == 'r') usb_attach();
    leave = 0;
  }
}
