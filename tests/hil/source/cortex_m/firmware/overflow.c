/* SPDX-License-Identifier: Apache-2.0 */
/* A stack that grows out of the SRAM. */
#include "stm32f103.h"

__attribute__((noinline)) static uint32_t deeper(volatile uint32_t* above) {
  volatile uint32_t frame[64];
  frame[0] = *above + 1U;
  return frame[0] == 0 ? 0 : deeper(frame) + frame[0];
}

int main(void) {
  set_clock();
  volatile uint32_t start = 0;
  return (int)deeper(&start);
}
