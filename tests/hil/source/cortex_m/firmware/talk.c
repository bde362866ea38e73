/* SPDX-License-Identifier: Apache-2.0 */
/* Says a line at 115 200 baud. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  set_uart(115200);
  say("steady\n");
  for (;;) wait_for_interrupt();
}
