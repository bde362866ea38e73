/* SPDX-License-Identifier: Apache-2.0 */
/* Vector table and start of the conformance images; no vendor code. */
#include <stdint.h>

extern uint32_t stack_top, data_begin, data_end, data_image, bss_begin, bss_end;
int main(void);
void start(void);

void stay(void) {
  for (;;) {
  }
}

#define HANDLER(name) void name(void) __attribute__((weak, alias("stay")))
HANDLER(on_nmi);
HANDLER(on_hard_fault);
HANDLER(on_bus_fault);
HANDLER(on_usage_fault);
HANDLER(on_svcall);
HANDLER(on_pendsv);
HANDLER(on_systick);
HANDLER(on_exti0);
HANDLER(on_exti1);
HANDLER(on_exti2);
HANDLER(on_dma1);
HANDLER(on_dma4);
HANDLER(on_dma5);
HANDLER(on_usb);
HANDLER(on_exti9_5);
HANDLER(on_tim1_up);
HANDLER(on_tim1_cc);
HANDLER(on_tim2);
HANDLER(on_tim3);
HANDLER(on_tim4);
HANDLER(on_usart1);
HANDLER(on_usb_wake);

__attribute__((section(".vectors"), used)) static const void* const kVectors[16 + 43] = {
    [0] = &stack_top,
    [1] = start,
    [2] = on_nmi,
    [3] = on_hard_fault,
    [4] = stay,
    [5] = on_bus_fault,
    [6] = on_usage_fault,
    [11] = on_svcall,
    [14] = on_pendsv,
    [15] = on_systick,
    [16 + 6] = on_exti0,
    [16 + 7] = on_exti1,
    [16 + 8] = on_exti2,
    [16 + 11] = on_dma1,
    [16 + 14] = on_dma4,
    [16 + 15] = on_dma5,
    [16 + 20] = on_usb,
    [16 + 23] = on_exti9_5,
    [16 + 25] = on_tim1_up,
    [16 + 27] = on_tim1_cc,
    [16 + 28] = on_tim2,
    [16 + 29] = on_tim3,
    [16 + 30] = on_tim4,
    [16 + 37] = on_usart1,
    [16 + 42] = on_usb_wake};

void start(void) {
  const uint32_t* from = &data_image;
  for (uint32_t* to = &data_begin; to < &data_end; ++to) *to = *from++;
  for (uint32_t* to = &bss_begin; to < &bss_end; ++to) *to = 0;
  (void)main();
  stay();
}
