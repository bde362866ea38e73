/* SPDX-License-Identifier: Apache-2.0 */
/* A hole among the devices. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  REG(0x40001C00) = 1;
  return 0;
}
