/* SPDX-License-Identifier: Apache-2.0 */
/* The core on an ATmega2560: Timer1 gives the ticks, Timer3 the time of belt edges, Timer4 counts those of
 * the power meter, USART0 the host. */
#include "firmware_under_test/controller/core/belt.h"
#include "firmware_under_test/controller/core/controller.h"
#include "firmware_under_test/controller/core/engine.h"
#include "firmware_under_test/controller/core/power_loop.h"
#include "hal.h"

volatile uint8_t kb_rx_bytes[256];
volatile uint8_t kb_rx_end;
uint8_t kb_rx_first;
volatile uint8_t kb_rx_errors;

ISR(TIMER1_COMPA_vect) {
#ifdef KB_DEFECT_PULSES_LOST
  /* Defect: "the UART must not overrun", so a tick gives way to a waiting byte, and its steps are gone. */
  if (UCSR0A & _BV(RXC0)) {
    kb_engine.out_a = kb_engine.idle_a;
  }
#endif
  /* Set-up time of DIR: from the end of the tick before, in case this one waited for it, to PUL. The
   * instructions between make it 5 us. */
  const uint8_t inputs = PINL;
  const uint8_t out_c = kb_engine.out_c;
  __builtin_avr_delay_cycles(2);
#ifdef KB_DEFECT_DIR_LATE
  /* Defect: DIR is written with the step that needs it, and 2 us after its PUL. */
  static uint8_t shown;
  const uint8_t steps = kb_engine.out_a & KB_PUL_A;
  const uint8_t stepping_dirs = (uint8_t)(steps << 1);
  PORTA = steps | shown;
  PORTC = out_c;
  __builtin_avr_delay_cycles(14); /* Delay of 2 us with the code around it, as measured. */
  shown = (uint8_t)((shown & ~stepping_dirs) | (kb_engine.out_a & stepping_dirs));
  PORTA = steps | shown;
#else
  PORTA = kb_engine.out_a;
  PORTC = out_c;
#endif
  if (kb_tick_begins_period()) {
    kb_tick_boundary(TCNT3);
    kb_power_counter = TCNT4L;
  }
  kb_tick_compute(inputs, false);
#ifdef KB_DEFECT_DIR_LATE
  PORTA = shown;
#else
  PORTA = kb_engine.idle_a;
#endif
  PORTC = (uint8_t)((out_c & (uint8_t) ~(KB_FEED_PUL | KB_FEED_DIR)) | kb_engine.idle_c);
}

/* The longer tick, used while some axis needs pulses that stay active over ticks. */
ISR(TIMER1_COMPB_vect) {
  const uint8_t inputs = PINL;
  const uint8_t out_c = kb_engine.out_c;
  const uint8_t held = kb_engine.held;
  PORTA = kb_engine.out_a;
  PORTC = out_c;
  if (kb_tick_begins_period()) {
    kb_tick_boundary(TCNT3);
    kb_power_counter = TCNT4L;
  }
  kb_tick_compute(inputs, true);
  PORTA = kb_level_a(held);
  PORTC = kb_level_c(held, out_c);
}

ISR(INT2_vect) {
  const uint8_t pins = PIND;
  kb_belt_edge((uint8_t)(pins >> 1) & KB_A, pins & KB_B, TCNT3);
}

ISR(INT3_vect) { kb_belt_mark_edge(TCNT3); }

ISR(USART0_RX_vect) {
  if (UCSR0A & (_BV(FE0) | _BV(DOR0))) { /* Line errors of the byte that the next read takes. */
    kb_rx_errors = (uint8_t)(kb_rx_errors + 1U);
  }
  kb_rx_bytes[kb_rx_end++] = UDR0;
}

int main(void) {
  /* The watchdog stays on over its own reset. Its period is 16 ms, reset only: with its interrupt on it would
   * not reset a controller whose interrupts are off. Reset releases all pins; the gate's input needs a
   * pull-down. */
  const uint8_t reset_cause = MCUSR;
  MCUSR = 0;
  wdt_enable(WDTO_15MS);
  /* The edges are set before anything else: the level mode of reset would fire, and slows an emulator
   * down. */
  EICRA = _BV(ISC20) | _BV(ISC31) | _BV(ISC30);
  DDRA = 0xFF;
  DDRC = KB_FEED_PUL | KB_FEED_DIR | KB_LASER_GATE | KB_LASER_PWM;

  kb_controller_init((reset_cause & _BV(WDRF)) ? KB_FAULT_WATCHDOG : KB_OK);

  UCSR0A = _BV(U2X0);
  UBRR0 = F_CPU / 8UL / KB_BAUD - 1UL;
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UCSR0B = _BV(RXCIE0) | _BV(RXEN0) | _BV(TXEN0);

  TCCR3B = _BV(CS31) | _BV(CS30);             /* clock / 64 */
  TCCR4B = _BV(CS42) | _BV(CS41) | _BV(CS40); /* rising edges of T4 */
  OCR1A = KB_TICK_CYCLES - 1U;
  OCR1B = KB_TICK_CYCLES - 1U;
  TIMSK1 = _BV(OCIE1A);
  TCCR1B = _BV(WGM12) | _BV(CS10);

  EIFR = _BV(INTF2) | _BV(INTF3);
  EIMSK = _BV(INT2) | _BV(INT3);
  sei();
  for (;;) {
    kb_controller_poll();
  }
}
