/* SPDX-License-Identifier: Apache-2.0 */
/* Registers of the STM32F103 that the conformance images use (STMicroelectronics 2015 RM0008, ARM 2010). */
#ifndef KERFBENCH_TESTS_STM32F103_H
#define KERFBENCH_TESTS_STM32F103_H

#include <stdint.h>

#define REG(address) (*(volatile uint32_t*)(address))

#define RCC_CR REG(0x40021000)
#define RCC_CFGR REG(0x40021004)
#define RCC_AHBENR REG(0x40021014)
#define RCC_APB2ENR REG(0x40021018)
#define RCC_APB1ENR REG(0x4002101C)
#define RCC_CSR REG(0x40021024)
#define FLASH_ACR REG(0x40022000)
#define FLASH_KEYR REG(0x40022004)
#define FLASH_SR REG(0x4002200C)
#define FLASH_CR REG(0x40022010)
#define FLASH_AR REG(0x40022014)

#define GPIO(port, offset) REG(0x40010800 + (port)*0x400 + (offset))
#define GPIOA_CRL GPIO(0, 0x00)
#define GPIOA_CRH GPIO(0, 0x04)
#define GPIOA_IDR GPIO(0, 0x08)
#define GPIOA_ODR GPIO(0, 0x0C)
#define GPIOA_BSRR GPIO(0, 0x10)
#define GPIOA_BRR GPIO(0, 0x14)
#define GPIOB_CRL GPIO(1, 0x00)
#define GPIOB_CRH GPIO(1, 0x04)
#define GPIOB_IDR GPIO(1, 0x08)
#define GPIOB_ODR GPIO(1, 0x0C)
#define GPIOB_BSRR GPIO(1, 0x10)

#define AFIO_MAPR REG(0x40010004)
#define AFIO_EXTICR1 REG(0x40010008)
#define EXTI_IMR REG(0x40010400)
#define EXTI_EMR REG(0x40010404)
#define EXTI_RTSR REG(0x40010408)
#define EXTI_FTSR REG(0x4001040C)
#define EXTI_PR REG(0x40010414)

#define TIM(n, offset) REG(((n) == 1 ? 0x40012C00 : 0x40000000 + ((n)-2) * 0x400) + (offset))
#define TIM_CR1 0x00
#define TIM_SMCR 0x08
#define TIM_DIER 0x0C
#define TIM_SR 0x10
#define TIM_EGR 0x14
#define TIM_CCMR1 0x18
#define TIM_CCMR2 0x1C
#define TIM_CCER 0x20
#define TIM_CNT 0x24
#define TIM_PSC 0x28
#define TIM_ARR 0x2C
#define TIM_RCR 0x30
#define TIM_CCR1 0x34
#define TIM_CCR2 0x38
#define TIM_CCR3 0x3C
#define TIM_CCR4 0x40
#define TIM_BDTR 0x44

#define USART1_SR REG(0x40013800)
#define USART1_DR REG(0x40013804)
#define USART1_BRR REG(0x40013808)
#define USART1_CR1 REG(0x4001380C)
#define USART1_CR2 REG(0x40013810)
#define USART1_CR3 REG(0x40013814)

#define DMA_ISR REG(0x40020000)
#define DMA_IFCR REG(0x40020004)
#define DMA_CCR(n) REG(0x40020008 + ((n)-1) * 0x14)
#define DMA_CNDTR(n) REG(0x4002000C + ((n)-1) * 0x14)
#define DMA_CPAR(n) REG(0x40020010 + ((n)-1) * 0x14)
#define DMA_CMAR(n) REG(0x40020014 + ((n)-1) * 0x14)

#define IWDG_KR REG(0x40003000)
#define IWDG_PR REG(0x40003004)
#define IWDG_RLR REG(0x40003008)

#define USB_EP(n) REG(0x40005C00 + 4 * (n))
#define USB_CNTR REG(0x40005C40)
#define USB_ISTR REG(0x40005C44)
#define USB_FNR REG(0x40005C48)
#define USB_DADDR REG(0x40005C4C)
#define USB_BTABLE REG(0x40005C50)
/* A half-word of the packet memory, by its address on the USB's side. */
#define USB_MEMORY(address) REG(0x40006000 + 2 * (address))

#define SYST_CSR REG(0xE000E010)
#define SYST_RVR REG(0xE000E014)
#define SYST_CVR REG(0xE000E018)
#define NVIC_ISER(n) REG(0xE000E100 + 4 * (n))
#define NVIC_ISPR(n) REG(0xE000E200 + 4 * (n))
#define NVIC_IPR(irq) (*(volatile uint8_t*)(0xE000E400 + (irq)))
#define SCB_ICSR REG(0xE000ED04)
#define SCB_AIRCR REG(0xE000ED0C)
#define SCB_SHPR(exception) (*(volatile uint8_t*)(0xE000ED18 + (exception)-4))
#define SCB_SHCSR REG(0xE000ED24)
#define SCB_CFSR REG(0xE000ED28)
#define SCB_BFAR REG(0xE000ED38)
#define DEMCR REG(0xE000EDFC)
#define DWT_CTRL REG(0xE0001000)
#define DWT_CYCCNT REG(0xE0001004)

enum {
  IRQ_EXTI0 = 6,
  IRQ_EXTI1 = 7,
  IRQ_EXTI2 = 8,
  IRQ_DMA1 = 11,
  IRQ_DMA4 = 14,
  IRQ_DMA5 = 15,
  IRQ_USB = 20,
  IRQ_TIM1_UP = 25,
  IRQ_TIM1_CC = 27,
  IRQ_TIM2 = 28,
  IRQ_TIM3 = 29,
  IRQ_TIM4 = 30,
  IRQ_USART1 = 37,
  IRQ_USB_WAKE = 42
};

static inline void enable_interrupt(unsigned irq) { NVIC_ISER(irq / 32) = 1U << (irq % 32); }
static inline void wait_for_interrupt(void) { __asm__ volatile("wfi"); }

/* 72 MHz from a crystal of 8 MHz, APB1 with 36 MHz, two wait states; all devices on. */
static inline void set_clock(void) {
  FLASH_ACR = 0x12;
  RCC_CR |= 1U << 16;
  while ((RCC_CR & (1U << 17)) == 0) {
  }
  RCC_CFGR = 7U << 18 | 1U << 16 | 4U << 8;
  RCC_CR |= 1U << 24;
  while ((RCC_CR & (1U << 25)) == 0) {
  }
  RCC_CFGR |= 2U;
  while ((RCC_CFGR & 0xCU) != 8U) {
  }
  RCC_AHBENR |= 1U;
  RCC_APB2ENR = 0x4E7D;
  RCC_APB1ENR = 0x18060007;
}

/* PA0 to PA7 are outputs. */
static inline void set_outputs(void) { GPIOA_CRL = 0x33333333; }

static inline void set_uart(uint32_t baud) {
  GPIOA_CRH = 0x444444B4;
  USART1_BRR = (72000000U + baud / 2) / baud;
  USART1_CR1 = 1U << 13 | 3U << 2;
}

static inline void say(const char* text) {
  for (; *text != 0; ++text) {
    while ((USART1_SR & 0x80U) == 0) {
    }
    USART1_DR = (uint8_t)*text;
  }
}

static inline void say_number(uint32_t number) {
  char digits[11];
  int at = 10;
  digits[at] = 0;
  do {
    digits[--at] = (char)('0' + number % 10U);
    number /= 10U;
  } while (number != 0);
  say(digits + at);
  say("\n");
}

#endif
