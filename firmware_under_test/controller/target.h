/* SPDX-License-Identifier: Apache-2.0 */
/* Time base and sizes of the controllers that the core is built for. A host must not rely on them: it reads
 * them from the image or from INFO (release.h).
 *
 * A step tick of KB_TICK_CYCLES; an interpolation period of KB_TICKS_PER_PERIOD ticks, a power of two up to
 * 128; an axis makes at most KB_MAX_STEPS_PER_PERIOD steps in a period, one in a tick. */
#ifndef KERFBENCH_CONTROLLER_TARGET_H
#define KERFBENCH_CONTROLLER_TARGET_H

#include <stdint.h>

#ifdef KB_TARGET_STM32
#define KB_CPU_HZ 72000000UL
#elif defined(KB_TARGET_MCS51)
#define KB_CPU_HZ 24000000UL
#else
#define KB_CPU_HZ 16000000UL
#endif

#if defined(KB_TARGET_MCS51)
/* STC15W4K32S4, an 8051 of one clock a machine cycle, at 24 MHz: ticks of 100 us, periods of 3.2 ms. */
#define KB_TARGET_NAME "mcs51"
#define KB_BAUD 125000UL
#define KB_TICK_CYCLES 2400U
#define KB_TICKS_PER_PERIOD 32U
#define KB_QUEUE_SIZE 1024U
#define KB_TIME_CYCLES 12U
#define KB_PWM_TICKS 1U
#define KB_LASER_EVENTS 8U
#define KB_SETUP_CYCLES 120U
#define KB_HOLD_CYCLES 150U
#define KB_WIDTH_CYCLES 150U
#define KB_SPACE_CYCLES 120U
#define KB_LATE_CYCLES 400U
typedef uint8_t kb_ticks_t;
#elif defined(KB_TARGET_GALVO)
/* Digital galvos with PUL/DIR inputs of some MHz: ticks of 1 us, periods of 128 us. The target stands for the
 * core's interpolation on a processor that is fast enough for it, or in front of a pulse generator in logic;
 * here it runs on a computer, where it takes no time. */
#define KB_TARGET_NAME "galvo"
#define KB_BAUD 2000000UL
#define KB_TICK_CYCLES 16U
#define KB_TICKS_PER_PERIOD 128U
#define KB_QUEUE_SIZE 32768U /* size in bytes; one byte less can be filled */
#define KB_TIME_CYCLES 16U
#define KB_PWM_TICKS 8U
#define KB_LASER_EVENTS 64U
#define KB_SETUP_CYCLES 9U /* shortest times of PUL and DIR, see release.h */
#define KB_HOLD_CYCLES 7U
#define KB_WIDTH_CYCLES 7U
#define KB_SPACE_CYCLES 9U
#define KB_LATE_CYCLES 0U /* longest lateness of a tick */
typedef uint16_t kb_ticks_t;
#elif defined(KB_TARGET_STM32)
/* STM32F103 at 72 MHz, in ticks, periods and pulses as long as the AVR's, so that both make the same pulses
 * of the same program. */
#define KB_TARGET_NAME "stm32"
#define KB_BAUD 250000UL
#define KB_TICK_CYCLES 1800U
#define KB_TICKS_PER_PERIOD 32U
#define KB_QUEUE_SIZE 4096U
#define KB_TIME_CYCLES 288U
#define KB_PWM_TICKS 1U
#define KB_LASER_EVENTS 16U
#define KB_PULSE_COUNT 540U /* count of the tick's timer at which PUL ends */
#define KB_SETUP_CYCLES 360U
#define KB_HOLD_CYCLES 450U
#define KB_WIDTH_CYCLES 450U
#define KB_SPACE_CYCLES 360U
#define KB_LATE_CYCLES 1170U
typedef uint8_t kb_ticks_t;
#else
/* ATmega2560 at 16 MHz at its limit: ticks of 25 us, periods of 0.8 ms. */
#define KB_TARGET_NAME "avr"
#define KB_BAUD 250000UL
#define KB_TICK_CYCLES 400U
#define KB_TICKS_PER_PERIOD 32U
#define KB_QUEUE_SIZE 4096U
#define KB_TIME_CYCLES 64U /* unit of the timer that stamps belt edges */
#define KB_PWM_TICKS 1U    /* ticks of one bit of the laser's PWM */
#define KB_LASER_EVENTS 16U
#define KB_SETUP_CYCLES 80U
#define KB_HOLD_CYCLES 100U
#define KB_WIDTH_CYCLES 100U
#define KB_SPACE_CYCLES 80U
#define KB_LATE_CYCLES 260U
typedef uint8_t kb_ticks_t;
#endif

#define KB_MAX_STEPS_PER_PERIOD ((int8_t)(KB_TICKS_PER_PERIOD - 1U))
/* Each period may change the laser once, and the ring of changes on their way must hold them. */
#define KB_LONGEST_DELAY_TICKS                                    \
  ((KB_LASER_EVENTS - 1U) * KB_TICKS_PER_PERIOD > (kb_ticks_t)~0U \
       ? (kb_ticks_t)~0U                                          \
       : (KB_LASER_EVENTS - 1U) * KB_TICKS_PER_PERIOD)
#define KB_PERIOD_CYCLES (1UL * KB_TICK_CYCLES * KB_TICKS_PER_PERIOD)
/* Number of whole periods in this many milliseconds. */
#define KB_PERIODS_IN_MS(ms) ((ms) * (KB_CPU_HZ / 1000UL) / KB_PERIOD_CYCLES)

#endif
