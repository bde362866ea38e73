/* SPDX-License-Identifier: Apache-2.0 */
/* Gives back what it gets. A line that begins with ? is followed by a report, one with ! halts the endpoint
 * to the host, as after an error. */
#include "usb_serial.h"

static void add_text(const char* text) {
  for (; *text != 0; ++text) add((uint8_t)*text);
}

static void add_number(uint32_t number) {
  char digits[12];
  int at = 11;
  digits[at] = 0;
  do {
    digits[--at] = (char)('0' + number % 10U);
    number /= 10U;
  } while (number != 0);
  add_text(digits + at);
  add(' ');
}

static void on_line(char first) {
  if (first == '?') {
    add_number((uint32_t)line_coding[0] | (uint32_t)line_coding[1] << 8 | (uint32_t)line_coding[2] << 16);
    add_number(line_coding[6]);
    add_number(control_lines);
    add_number(suspends);
    add_number(wakes);
    add_text("\n");
  }
  if (first == '!') {
    sends = 1;
    set_state(1, TX_STATE, TX_STALL);
  }
}

int main(void) {
  usb_start();
  GPIOA_CRH = 0x44433444; /* the port would drive PA11 and PA12, and the USB has them */
  for (;;) {
    GPIOA_ODR ^= 1U << 11;
    wait_for_interrupt();
  }
}
