/* SPDX-License-Identifier: Apache-2.0 */
/* A jump into a string. */
#include "stm32f103.h"

static const uint16_t kData[] = {0xDE00, 0xDE00, 0xFFFF};

int main(void) {
  set_clock();
  ((void (*)(void))((uint32_t)kData | 1U))();
  return 0;
}
