/* SPDX-License-Identifier: Apache-2.0 */
#include "stm32f103.h"

int main(void) {
  set_clock();
  (void)REG(0x50000010);
  return 0;
}
