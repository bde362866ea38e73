/* SPDX-License-Identifier: Apache-2.0 */
#include "stm32f103.h"

int main(void) {
  set_clock();
  __asm__ volatile("udf #0");
  return 0;
}
