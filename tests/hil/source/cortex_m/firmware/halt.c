/* SPDX-License-Identifier: Apache-2.0 */
/* Sleep that nothing ends. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  for (;;) wait_for_interrupt();
}
