/* SPDX-License-Identifier: Apache-2.0 */
/* A jump to an even address, as for long instructions of other ARM cores. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  ((void (*)(void))0x08000100)();
  return 0;
}
