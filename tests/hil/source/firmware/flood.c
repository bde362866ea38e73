/* SPDX-License-Identifier: Apache-2.0 */
#include <avr/io.h>

int main(void) {
  DDRA = 1;
  for (;;) PINA = 1;
}
