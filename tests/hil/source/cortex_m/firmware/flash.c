/* SPDX-License-Identifier: Apache-2.0 */
/* Erases the last page and programs it, wrongly too, and says what the flash holds and reports. */
#include "stm32f103.h"

#define PAGE 0x0800FC00U
static volatile uint16_t* const page = (volatile uint16_t*)PAGE;

int main(void) {
  set_clock();
  set_uart(250000);
  say_number(FLASH_CR & 0x80U); /* locked */
  page[0] = 0x1234;
  say_number(FLASH_SR); /* PGERR */
  FLASH_SR = 0x34;
  FLASH_KEYR = 0x45670123;
  FLASH_KEYR = 0xCDEF89AB;
  say_number(FLASH_CR & 0x80U);
  FLASH_CR = 1;
  page[0] = 0x1234;
  page[1] = 0x5678;
  say_number(*(volatile uint32_t*)PAGE);
  say_number(FLASH_SR); /* EOP */
  FLASH_SR = 0x34;
  page[0] = 0x1111; /* not erased */
  say_number(FLASH_SR);
  say_number(page[0]);
  FLASH_SR = 0x34;
  FLASH_CR = 2;
  FLASH_AR = PAGE;
  FLASH_CR = 0x42;
  say_number(*(volatile uint32_t*)PAGE);
  FLASH_CR = 0x80;
  for (;;) wait_for_interrupt();
}
