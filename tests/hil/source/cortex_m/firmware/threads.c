/* SPDX-License-Identifier: Apache-2.0 */
/* Two threads on stacks of their own, switched by PendSV from SysTick as small kernels do: one counts on, the
 * other says how far the first has come and what IPSR is in thread and handler. */
#include "stm32f103.h"

static uint32_t stacks[2][128];
static uint32_t* tops[2];
static unsigned running;
static volatile uint32_t counted;
static volatile uint32_t ticks;
static volatile uint32_t handler_ipsr;

static uint32_t ipsr(void) {
  uint32_t value;
  __asm__ volatile("mrs %0, ipsr" : "=r"(value));
  return value;
}

__attribute__((used)) static uint32_t* change(uint32_t* top) {
  tops[running] = top;
  running ^= 1U;
  return tops[running];
}

__attribute__((naked)) void on_pendsv(void) {
  __asm__ volatile(
      "mrs r0, psp\n stmdb r0!, {r4-r11}\n push {r3, lr}\n bl change\n pop {r3, lr}\n ldmia r0!, {r4-r11}\n"
      "msr psp, r0\n bx lr\n");
}

void on_systick(void) {
  ++ticks;
  handler_ipsr = ipsr();
  SCB_ICSR = 1U << 28;
}

static void counter(void) {
  for (;;) {
    if (counted < ticks) ++counted;
  }
}

static void speaker(void) {
  while (ticks < 20) {
  }
  say_number(counted > 5 ? 1 : 0);
  say_number(ipsr());
  say_number(handler_ipsr);
  for (;;) {
  }
}

static void prepare(unsigned thread, void (*function)(void)) {
  uint32_t* top = &stacks[thread][128 - 16];
  top[8 + 6] = (uint32_t)function;
  top[8 + 7] = 1U << 24;
  tops[thread] = top;
}

int main(void) {
  set_clock();
  set_uart(250000);
  prepare(0, counter);
  prepare(1, speaker);
  SCB_SHPR(14) = 0xF0;
  SYST_RVR = 7199;
  SYST_CVR = 0;
  /* This function becomes thread 0's stand-in: its context is never taken up again. */
  running = 0;
  __asm__ volatile("msr psp, %0\n movs r1, #2\n msr control, r1\n isb\n" ::"r"(&stacks[0][100])
                   : "r1", "memory");
  SYST_CSR = 7;
  counter();
  return 0;
}
