/* SPDX-License-Identifier: Apache-2.0 */
/* A laser cutter's firmware as some other house would write it: ATmega328P, G-code a line at a time with ok,
 * Grbl's pins for its two axes. It knows nothing of belts, sheets or lenses; its unit is the milliradian of a
 * mirror.
 *
 *   G0 X Y          dark, at RAPID         G1 X Y F        at F units a minute, lit after M3
 *   M3 S0…1000      laser armed, S of 1000 M5, M2          laser off
 *   G90             accepted               ?               <Idle> or <Run>
 *   error:1 no such word, error:2 bad number, error:15 outside the travel
 *   error:20 no such command, error:22 bad feed
 *
 * With OWN_JOB, a file of such lines that is linked in, it runs these when the button at PC5 is pressed, and
 * nobody talks to it.
 *
 * PD2, PD3 step of X and Y; PD5, PD6 direction, high: plus. PB4 laser gate, PB3 (OC2A) laser power.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <math.h>
#include <stdint.h>
#include <util/delay.h>

#define STEPS_PER_UNIT 80L
/* travel of 180 units either way: differences fit 16 bits with their Bresenham sum */
#define MAX_STEPS 14400L
#define MIN_FEED 300L /* units a minute; at a slower feed a period overflows timer 1 */
#define MAX_FEED 15000L
#define RAPID 9000L
#define ARRIVE_CYCLES 16000 /* time for the mirrors to swing out before the laser comes on: 1 ms */
#define TRAIL_CYCLES 3000   /* time for the mirrors to arrive before the laser goes off: 0.19 ms */
#define IDLE_CYCLES 1600

#define STEP_X (1 << PD2)
#define STEP_Y (1 << PD3)
#define DIR_X (1 << PD5)
#define DIR_Y (1 << PD6)
#define LASER_PWM (1 << PB3)
#define LASER_GATE (1 << PB4)

/* A straight move, or with steps = 0 a rest of one period. */
struct block {
  uint16_t dx, dy, steps, cycles;
  uint8_t directions;
  uint8_t lit;
  uint8_t duty;
};

static struct block queue[8];
static volatile uint8_t queue_head, queue_tail;
static volatile uint8_t running;
static uint16_t steps_left, sum_x, sum_y;

static volatile uint8_t ring[128];
static volatile uint8_t ring_head, asked;

ISR(USART_RX_vect) {
  const uint8_t c = UDR0;
  if (c == '?') {
    asked = 1;
  } else {
    ring[ring_head] = c;
    ring_head = (uint8_t)((ring_head + 1U) % sizeof ring);
  }
}

static void light(uint8_t lit, uint8_t duty) {
  if (lit && duty) {
    OCR2A = duty;
    TCCR2A = (1 << COM2A1) | (1 << WGM21) | (1 << WGM20);
    PORTB |= LASER_GATE;
  } else {
    PORTB &= (uint8_t)~LASER_GATE;
    TCCR2A = (1 << WGM21) | (1 << WGM20);
  }
}

static void begin_block(void) {
  if (queue_tail == queue_head) {
    light(0, 0);
    running = 0;
    OCR1A = IDLE_CYCLES - 1;
    return;
  }
  const struct block* b = &queue[queue_tail];
  const uint8_t directions = (uint8_t)((PORTD & (uint8_t) ~(DIR_X | DIR_Y)) | b->directions);
  if (directions != PORTD) {
    _delay_us(4); /* the drives need 5 us of hold after the last step; the code up to here took the rest */
    PORTD = directions;
  }
  light(b->lit, b->duty);
  OCR1A = b->cycles - 1;
  steps_left = b->steps;
  sum_x = sum_y = b->steps / 2;
  running = 1;
}

ISR(TIMER1_COMPA_vect) {
  if (!running) {
    begin_block();
    return;
  }
  if (steps_left != 0) {
    const struct block* b = &queue[queue_tail];
    uint8_t pulses = 0;
    sum_x += b->dx;
    if (sum_x >= b->steps) {
      sum_x -= b->steps;
      pulses |= STEP_X;
    }
    sum_y += b->dy;
    if (sum_y >= b->steps) {
      sum_y -= b->steps;
      pulses |= STEP_Y;
    }
    PORTD |= pulses;
    _delay_us(3);
    PORTD &= (uint8_t) ~(STEP_X | STEP_Y);
    if (--steps_left != 0) return;
  }
  queue_tail = (uint8_t)((queue_tail + 1U) % (sizeof queue / sizeof queue[0]));
  begin_block();
}

static void put(const char* text) {
  for (; *text; ++text) {
    while (!(UCSR0A & (1 << UDRE0))) {
    }
    UDR0 = (uint8_t)*text;
  }
}

static void answer_question(void) {
  if (!asked) return;
  asked = 0;
  put(running || queue_head != queue_tail ? "<Run>\r\n" : "<Idle>\r\n");
}

static void push(const struct block* b) {
  const uint8_t next = (uint8_t)((queue_head + 1U) % (sizeof queue / sizeof queue[0]));
  while (next == queue_tail) answer_question();
  queue[queue_head] = *b;
  __asm__ volatile("" ::: "memory");
  queue_head = next;
}

/* ---- State after the lines so far. */
static int16_t at_x, at_y; /* place at the end of the queue, steps */
static int32_t feed = 0;
static uint8_t armed, duty, last_lit, last_duty, last_directions;

static void rest(uint16_t cycles, uint8_t lit, uint8_t rest_duty) {
  const struct block b = {.cycles = cycles, .directions = last_directions, .lit = lit, .duty = rest_duty};
  push(&b);
}

static void go_dark(void) {
  if (last_lit) rest(TRAIL_CYCLES, 1, last_duty);
  last_lit = 0;
}

static const char* move(int16_t x, int16_t y, uint8_t cutting) {
  const int32_t speed = cutting ? feed : RAPID;
  if (speed < MIN_FEED || speed > MAX_FEED) return "error:22\r\n";
  struct block b = {.directions = (uint8_t)((x > at_x ? DIR_X : 0) | (y > at_y ? DIR_Y : 0))};
  b.dx = (uint16_t)(x > at_x ? x - at_x : at_x - x);
  b.dy = (uint16_t)(y > at_y ? y - at_y : at_y - y);
  b.steps = b.dx > b.dy ? b.dx : b.dy;
  if (b.steps == 0) return "ok\r\n";
  const float steps = sqrtf((float)b.dx * (float)b.dx + (float)b.dy * (float)b.dy);
  b.cycles =
      (uint16_t)((float)F_CPU * 60.0f / (float)STEPS_PER_UNIT * steps / ((float)speed * (float)b.steps) +
                 0.5f);
  b.lit = cutting && armed;
  b.duty = duty;
  if (!b.lit) go_dark();
  if (b.lit && !last_lit) rest(ARRIVE_CYCLES, 0, 0);
  last_lit = b.lit;
  last_duty = b.duty;
  last_directions = b.directions;
  push(&b);
  at_x = x;
  at_y = y;
  return "ok\r\n";
}

/* A decimal number in ten-thousandths; 0 if there is none, or it is too long. */
static uint8_t number(const char** text, int32_t* value) {
  const char* c = *text;
  const uint8_t negative = *c == '-';
  if (*c == '-' || *c == '+') ++c;
  int32_t whole = 0;
  uint8_t digits = 0;
  for (; *c >= '0' && *c <= '9'; ++c, ++digits) whole = 10 * whole + (*c - '0');
  if (digits > 5) return 0;
  whole *= 10000;
  if (*c == '.') {
    int32_t place = 1000;
    for (++c; *c >= '0' && *c <= '9'; ++c, ++digits, place /= 10) whole += place * (*c - '0');
  }
  *value = negative ? -whole : whole;
  *text = c;
  return digits != 0;
}

/* Converts ten-thousandths of a unit to steps. */
static uint8_t steps_of(int32_t value, int16_t* steps) {
  const int32_t per_step = 10000L / STEPS_PER_UNIT;
  const int32_t rounded = (value >= 0 ? value + per_step / 2 : value - per_step / 2) / per_step;
  if (rounded > MAX_STEPS || rounded < -MAX_STEPS) return 0;
  *steps = (int16_t)rounded;
  return 1;
}

static const char* execute(const char* line) {
  int16_t x = at_x, y = at_y;
  uint8_t moves = 0;
  static uint8_t mode; /* G0 or G1, which stays until the other comes */
  while (*line) {
    const char word = *line++;
    int32_t value;
    if (word == ' ') continue;
    if (word < 'A' || word > 'Z') return "error:1\r\n";
    if (!number(&line, &value)) return "error:2\r\n";
    const int32_t whole = value / 10000;
    switch (word) {
      case 'G':
        if (value == 0 || value == 10000) {
          mode = (uint8_t)whole;
        } else if (value != 900000) {
          return "error:20\r\n";
        }
        break;
      case 'M':
        if (value == 30000) {
          armed = 1;
        } else if (value == 50000 || value == 20000) {
          armed = 0;
          go_dark();
        } else {
          return "error:20\r\n";
        }
        break;
      case 'X':
        if (!steps_of(value, &x)) return "error:15\r\n";
        moves = 1;
        break;
      case 'Y':
        if (!steps_of(value, &y)) return "error:15\r\n";
        moves = 1;
        break;
      case 'F':
        feed = whole;
        break;
      case 'S':
        if (whole < 0 || whole > 1000) return "error:2\r\n";
        duty = (uint8_t)((whole * 255 + 500) / 1000);
        break;
      default:
        return "error:20\r\n";
    }
  }
  return moves ? move(x, y, mode) : "ok\r\n";
}

/* The next character for the interpreter; 0: there is none yet. */
#ifdef OWN_JOB
__asm__(
    ".section .progmem.data, \"a\", @progbits\n"
    "own_job: .incbin \"" OWN_JOB
    "\"\n"
    ".byte 0\n"
    ".previous\n");
extern const char own_job[] PROGMEM;

static char next_character(void) {
  static const char* at = own_job;
  static uint8_t started;
  if (PINC & (1 << PC5)) started = 1;
  if (!started) return 0;
  const char c = (char)pgm_read_byte(at);
  if (c) ++at;
  return c;
}
#else
static char next_character(void) {
  static uint8_t ring_tail;
  if (ring_tail == ring_head) return 0;
  const char c = (char)ring[ring_tail];
  ring_tail = (uint8_t)((ring_tail + 1U) % sizeof ring);
  return c;
}
#endif

int main(void) {
  DDRD = STEP_X | STEP_Y | DIR_X | DIR_Y;
  DDRB = LASER_PWM | LASER_GATE;
  UCSR0A = 1 << U2X0;
  UBRR0 = 16; /* 115 200 baud, as near as 16 MHz gets */
  UCSR0B = (1 << RXEN0) | (1 << TXEN0) | (1 << RXCIE0);
  TCCR2A = (1 << WGM21) | (1 << WGM20);
  TCCR2B = 1 << CS20; /* 62.5 kHz */
  OCR1A = IDLE_CYCLES - 1;
  TIMSK1 = 1 << OCIE1A;
  TCCR1B = (1 << WGM12) | (1 << CS10);
  sei();
  put("\r\nLinecutter 1.0\r\n");
  static char line[80];
  uint8_t length = 0;
  for (;;) {
    answer_question();
    const char c = next_character();
    if (c == 0) continue;
    if (c == '\n') {
      line[length] = 0;
      length = 0;
      if (line[0] != ';') put(execute(line));
    } else if (c != '\r' && length + 1U < sizeof line) {
      line[length++] = c;
    }
  }
}
