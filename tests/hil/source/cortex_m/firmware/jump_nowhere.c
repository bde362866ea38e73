/* SPDX-License-Identifier: Apache-2.0 */
#include "stm32f103.h"

int main(void) {
  set_clock();
  ((void (*)(void))0x30000001)();
  return 0;
}
