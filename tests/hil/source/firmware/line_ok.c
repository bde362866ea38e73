/* SPDX-License-Identifier: Apache-2.0 */
/* A tiny relative of Grbl: a banner, lines answered with ok, X<n> makes n pulses on PA0, '?' reports, E is an
 * error. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/delay.h>

static volatile uint16_t left;
static volatile uint8_t ring[256];
static volatile uint8_t head;
static uint8_t tail;

static void put(const char* text) {
  for (; *text; ++text) {
    while (!(UCSR0A & (1 << UDRE0))) {
    }
    UDR0 = (uint8_t)*text;
  }
}

ISR(USART0_RX_vect) { ring[head++] = UDR0; }

ISR(TIMER1_COMPA_vect) {
  if (left == 0) return;
  PORTA |= 1;
  --left;
  PORTA &= (uint8_t)~1;
}

int main(void) {
  DDRA = 1;
  UBRR0 = 8; /* 115 200 baud, as near as 16 MHz gets */
  UCSR0B = (1 << RXEN0) | (1 << TXEN0) | (1 << RXCIE0);
  OCR1A = 1599;
  TIMSK1 = 1 << OCIE1A;
  TCCR1B = (1 << WGM12) | (1 << CS10);
  sei();
  _delay_ms(20);
  put("\r\nTinyGrbl 1.1 ['$' for help]\r\n");
  uint16_t value = 0;
  uint8_t word = 0;
  for (;;) {
    while (tail == head) {
    }
    const uint8_t c = ring[tail++];
    if (c == '?') {
      put(left ? "<Run|MPos:0,0,0>\r\n" : "<Idle|MPos:0,0,0>\r\n");
    } else if (c == '\n') {
      if (word == 'E') {
        put("error:20\r\n");
      } else {
        while (left) {
        }
        if (word == 'X') {
          cli();
          left = value;
          sei();
        }
        put("ok\r\n");
      }
      word = 0;
      value = 0;
    } else if (c >= '0' && c <= '9') {
      value = (uint16_t)(value * 10 + (c - '0'));
    } else if (c == 'X' || c == 'E') {
      word = c;
    }
  }
}
