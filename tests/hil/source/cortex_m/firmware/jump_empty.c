/* SPDX-License-Identifier: Apache-2.0 */
/* A jump into flash that was never programmed. */
#include "stm32f103.h"

int main(void) {
  set_clock();
  ((void (*)(void))0x0800F001)();
  return 0;
}
