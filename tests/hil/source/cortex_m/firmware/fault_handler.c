/* SPDX-License-Identifier: Apache-2.0 */
/* A bus fault with a handler, which says where, and one without, which the handler of hard faults gets. */
#include "stm32f103.h"

static volatile uint32_t faults;

__attribute__((used)) static void step_over(uint32_t* frame) {
  ++faults;
  frame[6] += 2; /* the access is an instruction of one half-word */
}
__attribute__((naked)) void on_bus_fault(void) { __asm__ volatile("mov r0, sp\n b step_over\n"); }
__attribute__((naked)) void on_hard_fault(void) { __asm__ volatile("mov r0, sp\n b step_over\n"); }

static void access(uint32_t address) {
  register uint32_t at __asm__("r0") = address;
  register uint32_t value __asm__("r1");
  __asm__ volatile("ldr r1, [r0]\n" : "=r"(value) : "r"(at) : "memory");
}

int main(void) {
  set_clock();
  set_uart(250000);
  access(0x60000000);
  say_number(faults);
  SCB_SHCSR = 1U << 17;
  access(0x40001C00);
  say_number(faults);
  say_number(SCB_BFAR == 0x40001C00 ? 1 : 0);
  say_number(SCB_CFSR);
  for (;;) wait_for_interrupt();
}
