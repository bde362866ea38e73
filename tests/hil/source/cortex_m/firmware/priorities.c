/* SPDX-License-Identifier: Apache-2.0 */
/* Three interrupts made pending at once: EXTI2 is the most urgent, EXTI0 and EXTI1 are equal. From within
 * EXTI1 PendSV, the least urgent, and EXTI2 again are made pending. Each says its name on USART1 as it
 * begins. */
#include "stm32f103.h"

static char order[16];
static unsigned count;
static unsigned depth;

void on_exti0(void) { order[count++] = '0'; }
void on_exti1(void) {
  order[count++] = '1';
  ++depth;
  SCB_ICSR = 1U << 28;
  NVIC_ISPR(0) = 1U << IRQ_EXTI2;
  __asm__ volatile("dsb\n isb");
  order[count++] = 'b';
  --depth;
}
void on_exti2(void) { order[count++] = depth != 0 ? 'n' : '2'; }
void on_pendsv(void) { order[count++] = 'p'; }
void on_svcall(void) { order[count++] = 's'; }

int main(void) {
  set_clock();
  set_uart(250000);
  SCB_AIRCR = 0x05FA0300;
  NVIC_IPR(IRQ_EXTI0) = 0x80;
  NVIC_IPR(IRQ_EXTI1) = 0x80;
  NVIC_IPR(IRQ_EXTI2) = 0x10;
  SCB_SHPR(14) = 0xF0;
  enable_interrupt(IRQ_EXTI0);
  enable_interrupt(IRQ_EXTI1);
  enable_interrupt(IRQ_EXTI2);
  __asm__ volatile("cpsid i");
  NVIC_ISPR(0) = 1U << IRQ_EXTI0 | 1U << IRQ_EXTI1 | 1U << IRQ_EXTI2;
  order[count++] = 'm';
  __asm__ volatile("cpsie i\n isb");
  __asm__ volatile("svc 0");
  /* BASEPRI holds EXTI0 and lets EXTI2 through. */
  __asm__ volatile("msr basepri, %0" ::"r"(0x40));
  NVIC_ISPR(0) = 1U << IRQ_EXTI0 | 1U << IRQ_EXTI2;
  __asm__ volatile("dsb\n isb");
  order[count++] = 'h';
  __asm__ volatile("msr basepri, %0" ::"r"(0));
  __asm__ volatile("isb");
  order[count++] = '\n';
  say(order);
  for (;;) wait_for_interrupt();
}
