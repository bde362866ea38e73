/* SPDX-License-Identifier: Apache-2.0 */
/* The core on an STM32F103: TIM2 gives the ticks, TIM3 the time of belt edges, TIM4 counts those of the power
 * meter on PB6, USART1 is the host. PA0 to PA7 are the PUL and DIR of two pairs of axes, PB12 to PB15 those
 * of the feed, and gate and PWM of the laser; PB0 and PB1 the encoder, PB8 the print mark. */
#include "firmware_under_test/controller/core/belt.h"
#include "firmware_under_test/controller/core/controller.h"
#include "firmware_under_test/controller/core/engine.h"
#include "firmware_under_test/controller/core/power_loop.h"
#include "hal.h"

volatile uint8_t kb_rx_bytes[256];
volatile uint8_t kb_rx_end;
uint8_t kb_rx_first;
volatile uint8_t kb_rx_errors;

void kb_on_tick(void);
void kb_on_encoder(void);
void kb_on_mark(void);
void kb_on_byte(void);
int main(void);

enum { KB_C_SHIFT = 12 };

/* Both bytes of levels: one store each, and no other pin of the port changes. */
static inline void writeA(uint8_t levels) { GPIOA_BSRR = levels | (uint32_t)(uint8_t)~levels << 16; }
static inline void writeC(uint8_t levels) {
  GPIOB_BSRR = (uint32_t)(levels & 0xFU) << KB_C_SHIFT | (uint32_t)(~levels & 0xFU) << (KB_C_SHIFT + 16);
}

/* Levels that the end of PUL writes. */
static uint8_t end_a;
static uint8_t end_c;

/* Timer 2 makes two interrupts: one begins a tick and PUL, the other ends PUL at KB_PULSE_COUNT. */
static void endPulses(void) {
  writeA(end_a);
  writeC(end_c);
}

static void beginTick(void) {
#ifdef KB_DEFECT_PULSES_LOST
  /* Defect: "the UART must not overrun", so a tick gives way to a waiting byte, and its steps are gone. */
  if (kb_rx_first != kb_rx_end) {
    kb_engine.out_a = kb_engine.idle_a;
  }
#endif
  const uint8_t inputs = kb_hal_inputs();
  const uint8_t out_c = kb_engine.out_c;
  const uint8_t held = kb_engine.held;
#ifdef KB_DEFECT_DIR_LATE
  /* Defect: DIR is written with the step that needs it, and 2 us after its PUL. */
  static uint8_t shown;
  const uint8_t steps = kb_engine.out_a & KB_PUL_A;
  const uint8_t stepping_dirs = (uint8_t)(steps << 1);
  const uint32_t due = TIM2_CNT + 2U * (KB_CPU_HZ / 1000000UL);
  writeA(steps | shown);
  writeC(out_c);
  while (TIM2_CNT < due) {
  }
  shown = (uint8_t)((shown & ~stepping_dirs) | (kb_engine.out_a & stepping_dirs));
  writeA(steps | shown);
#else
  writeA(kb_engine.out_a);
  writeC(out_c);
#endif
  if (kb_tick_begins_period()) {
    kb_tick_boundary((uint16_t)TIM3_CNT);
    kb_power_counter = (uint8_t)TIM4_CNT;
  }
  kb_tick_compute(inputs, true);
#ifdef KB_DEFECT_DIR_LATE
  end_a = shown;
#else
  end_a = kb_level_a(held);
#endif
  end_c = kb_level_c(held, out_c);
}

void kb_on_tick(void) {
  enum { kUpdate = 1U, kCompare1 = 2U };
  const uint32_t flags = TIM2_SR;
  TIM2_SR = ~flags;
  if (flags & kUpdate) {
    beginTick();
  }
  if (flags & kCompare1) {
    endPulses();
  }
}

void kb_on_encoder(void) {
  EXTI_PR = 1U;
  const uint32_t pins = GPIOB_IDR;
  kb_belt_edge((uint8_t)(pins << 1) & KB_A, (uint8_t)pins & KB_B, (uint16_t)TIM3_CNT);
}

void kb_on_mark(void) {
  EXTI_PR = 1U << 8;
  kb_belt_mark_edge((uint16_t)TIM3_CNT);
}

void kb_on_byte(void) {
  if (USART1_SR & 0xEU) { /* Line errors of the byte that the next read takes. */
    kb_rx_errors = (uint8_t)(kb_rx_errors + 1U);
  }
  kb_rx_bytes[kb_rx_end++] = (uint8_t)USART1_DR;
}

/* 72 MHz from a crystal of 8 MHz; APB1 has 36 MHz, and its timers 72 MHz. */
static void setClock(void) {
  FLASH_ACR = 0x12; /* two wait states, prefetch */
  RCC_CR |= 1U << 16;
  while ((RCC_CR & (1U << 17)) == 0) {
  }
  RCC_CFGR = 7U << 18 | 1U << 16 | 4U << 8;
  RCC_CR |= 1U << 24;
  while ((RCC_CR & (1U << 25)) == 0) {
  }
  RCC_CFGR |= 2U;
  while ((RCC_CFGR & 0xCU) != 0x8U) {
  }
  RCC_APB2ENR = 1U << 14 | 1U << 3 | 1U << 2 | 1U; /* USART1, ports B and A, AFIO */
  RCC_APB1ENR = 7U;                                /* TIM2, TIM3, TIM4 */
}

static void setPins(void) {
  GPIOB_CRL = 0x44444444; /* inputs */
  GPIOB_CRH = 0x33334444; /* PB12 to PB15 are outputs */
  GPIOA_CRL = 0x33333333;
  GPIOA_CRH = 0x444444B4; /* PA9 is the transmitter's */
}

static void setTimers(void) {
  TIM3_PSC = KB_TIME_CYCLES - 1U;
  TIM3_EGR = 1U;
  TIM3_CR1 = 1U;
  TIM4_CCMR1 = 1U; /* rising edges of channel 1 */
  TIM4_SMCR = 0x57U;
  TIM4_CR1 = 1U;
  TIM2_ARR = KB_TICK_CYCLES - 1U;
  TIM2_CCR1 = KB_PULSE_COUNT;
  TIM2_DIER = 3U;
  TIM2_CR1 = 1U;
}

int main(void) {
  /* The watchdog's period is 16 ms by its own oscillator. Reset releases all pins; the gate's input needs a
   * pull-down. */
  const uint32_t reset_cause = RCC_CSR;
  RCC_CSR = 1U << 24;
  IWDG_KR = 0x5555;
  IWDG_PR = 0;
  IWDG_RLR = 159;
  IWDG_KR = 0xCCCC;
  setClock();
  setPins();

  kb_controller_init((reset_cause & (1U << 29)) ? KB_FAULT_WATCHDOG : KB_OK);

  USART1_BRR = KB_CPU_HZ / KB_BAUD;
  USART1_CR1 = 1U << 13 | 1U << 5 | 1U << 3 | 1U << 2;
  AFIO_EXTICR1 = 1U; /* PB0 */
  AFIO_EXTICR3 = 1U; /* PB8 */
  EXTI_RTSR = 1U << 8 | 1U;
  EXTI_FTSR = 1U;
  EXTI_PR = 1U << 8 | 1U;
  EXTI_IMR = 1U << 8 | 1U;
  setTimers();

  /* A tick interrupts all others, which do not interrupt each other. */
  NVIC_PRIORITY(KB_IRQ_EXTI0) = 0x10;
  NVIC_PRIORITY(KB_IRQ_EXTI9_5) = 0x10;
  NVIC_PRIORITY(KB_IRQ_USART1) = 0x10;
  NVIC_ISER0 = 1U << KB_IRQ_EXTI0 | 1U << KB_IRQ_EXTI9_5 | 1U << KB_IRQ_TIM2;
  NVIC_ISER1 = 1U << (KB_IRQ_USART1 - 32);
  __asm__ volatile("cpsie i");
  for (;;) {
    kb_controller_poll();
    __asm__ volatile("wfi"); /* until the next tick at the latest */
  }
}
