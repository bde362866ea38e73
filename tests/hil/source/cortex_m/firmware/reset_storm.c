/* SPDX-License-Identifier: Apache-2.0 */
/* Resets itself as soon as it runs. */
#include "stm32f103.h"

int main(void) {
  SCB_AIRCR = 0x05FA0004;
  for (;;) {
  }
}
