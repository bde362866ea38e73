/* SPDX-License-Identifier: Apache-2.0 */
/* A serial line on USB (CDC-ACM) that gives back what it gets, written for the tests from RM0008, USB 2.0 and
 * PSTN 1.2. Control packets have 8 bytes, so that nearly every answer takes several. PA0 changes with each
 * line. Images define what they do otherwise, and include this. */
#ifndef KERFBENCH_TESTS_USB_SERIAL_H
#define KERFBENCH_TESTS_USB_SERIAL_H

#include "stm32f103.h"

#ifndef DATA_CLASS
#define DATA_CLASS 0x0A
#define LINE_CLASS 0x02
#endif
#ifndef STALLED_REQUEST
#define STALLED_REQUEST 0xFF
#endif
#ifndef UNANSWERED_REQUEST
#define UNANSWERED_REQUEST 0xFF
#endif
#ifndef SEND_BUFFER
#define SEND_BUFFER 0x80
#endif
#ifndef RECEIVE_BLOCKS
#define RECEIVE_BLOCKS 0x8400 /* two blocks of 32 bytes */
#endif
#ifndef DATA_KIND
#define DATA_KIND 0
#endif
#ifndef ENDS_FULL_PACKETS
#define ENDS_FULL_PACKETS 1
#endif

enum { CONTROL_BYTES = 8, DATA_BYTES = 64, RING = 512 };
enum { RX = 0x8000, RX_STATE = 0x3000, SETUP = 0x0800, TX = 0x0080, TX_STATE = 0x0030, KEPT = 0x070F };
enum {
  RX_STALL = 0x1000,
  RX_NAK = 0x2000,
  RX_VALID = 0x3000,
  TX_STALL = 0x10,
  TX_NAK = 0x20,
  TX_VALID = 0x30
};
enum { FRES = 1, PDWN = 2, LP_MODE = 4, FSUSP = 8, RESET = 0x400, SUSP = 0x800, WKUP = 0x1000, CTR = 0x8000 };

static const uint8_t kDevice[18] = {18,   1,    0x00, 0x02, LINE_CLASS, 0, 0, CONTROL_BYTES, 0x09, 0x12, 0x01,
                                    0x00, 0x00, 0x01, 0,    1,          0, 1};
static const uint8_t kConfiguration[67] = {
    9, 2,    67,   0,    2,          1,          0,  0x80, 50, /* two interfaces */
    9, 4,    0,    0,    1,          LINE_CLASS, 2,  1,    0,  /* abstract control model */
    5, 0x24, 0,    0x10, 0x01,                                 /* header */
    5, 0x24, 1,    0,    1,                                    /* call management */
    4, 0x24, 2,    2,                                          /* line coding is known */
    5, 0x24, 6,    0,    1,                                    /* union */
    7, 5,    0x82, 3,    16,         0,          32,           /* notifications */
    9, 4,    1,    0,    2,          DATA_CLASS, 0,  0,    0,  /* data */
    7, 5,    0x01, 2,    DATA_BYTES, 0,          0,            /* from the host */
    7, 5,    0x81, 2,    DATA_BYTES, 0,          0};           /* to the host */
static const uint8_t kLanguages[4] = {4, 3, 0x09, 0x04};
static const uint8_t kProduct[12] = {12, 3, 'e', 0, 'c', 0, 'h', 0, 'o', 0, '!', 0};

static uint8_t line_coding[7];
static volatile uint32_t control_lines, suspends, wakes;
static const uint8_t* answer;
static unsigned answer_left, takes_coding, new_address;
static int answer_goes_on;
static uint8_t ring[RING];
static volatile unsigned ring_head, ring_tail;
static int sends, ends_full_packet, holds_off;

static inline void set_state(unsigned n, uint32_t mask, uint32_t state) {
  const uint32_t now = USB_EP(n);
  USB_EP(n) = ((now ^ state) & mask) | (now & KEPT) | RX | TX;
}
static inline void clear_flag(unsigned n, uint32_t flag) {
  USB_EP(n) = (USB_EP(n) & KEPT) | ((RX | TX) ^ flag);
}
static inline uint32_t descriptor(unsigned n, unsigned field) { return 8 * n + 2 * field; }
static inline unsigned received(unsigned n) { return USB_MEMORY(descriptor(n, 3)) & 0x3FFU; }
static inline uint8_t byte_at(uint32_t address) {
  return (uint8_t)(USB_MEMORY(address & ~1U) >> (8 * (address & 1U)));
}
static void put(unsigned n, const uint8_t* bytes, unsigned count) {
  const uint32_t to = USB_MEMORY(descriptor(n, 0));
  for (unsigned i = 0; i < count; i += 2)
    USB_MEMORY(to + i) = bytes[i] | (i + 1 < count ? (uint32_t)bytes[i + 1] << 8 : 0U);
  USB_MEMORY(descriptor(n, 1)) = count;
}

static void set_buffer(unsigned n, uint32_t send, uint32_t receive, uint32_t blocks) {
  USB_MEMORY(descriptor(n, 0)) = send;
  USB_MEMORY(descriptor(n, 1)) = 0;
  USB_MEMORY(descriptor(n, 2)) = receive;
  USB_MEMORY(descriptor(n, 3)) = blocks;
}

static void on_reset(void) {
  USB_BTABLE = 0;
  set_buffer(0, 0x40, 0x48, 4U << 10);
  USB_EP(0) = 0x0200;
  set_state(0, RX_STATE | TX_STATE, RX_VALID | TX_NAK);
  USB_DADDR = 0x80;
}

static void on_configured(void) {
  set_buffer(1, SEND_BUFFER, 0xC0, RECEIVE_BLOCKS);
  set_buffer(2, 0x50, 0, 0);
  USB_EP(1) = 1 | DATA_KIND | (USB_EP(1) & 0x7070); /* a written 1 toggles: all of them are 0 then */
  set_state(1, RX_STATE | TX_STATE, RX_VALID | TX_NAK);
  USB_EP(2) = 2 | 0x0600 | (USB_EP(2) & 0x7070);
  set_state(2, TX_STATE, TX_NAK);
  ring_head = ring_tail = 0;
  sends = ends_full_packet = holds_off = 0;
}

static void send_answer(void) {
  const unsigned count = answer_left < CONTROL_BYTES ? answer_left : CONTROL_BYTES;
  put(0, answer, count);
  answer += count;
  answer_left -= count;
  answer_goes_on = count == CONTROL_BYTES;
  set_state(0, TX_STATE | RX_STATE, TX_VALID | RX_VALID);
}

static void give(const uint8_t* bytes, unsigned count, unsigned asked) {
  answer = bytes;
  answer_left = count < asked ? count : asked;
  send_answer();
}

static void acknowledge(void) {
  answer_left = 0;
  answer_goes_on = 0;
  put(0, 0, 0);
  set_state(0, TX_STATE | RX_STATE, TX_VALID | RX_VALID);
}

static void refuse(void) { set_state(0, TX_STATE | RX_STATE, TX_STALL | RX_STALL); }

static void give_descriptor(unsigned kind, unsigned index, unsigned asked) {
  if (kind == 1) return give(kDevice, sizeof kDevice, asked);
  if (kind == 2) return give(kConfiguration, sizeof kConfiguration, asked);
  if (kind == 3 && index == 0) return give(kLanguages, sizeof kLanguages, asked);
  if (kind == 3 && index == 1) return give(kProduct, sizeof kProduct, asked);
  refuse();
}

static void on_setup(void) {
  uint8_t setup[8];
  for (unsigned i = 0; i < 8; ++i) setup[i] = byte_at(0x48 + i);
  if (setup[1] == UNANSWERED_REQUEST) return;
  if (setup[1] == STALLED_REQUEST) return refuse();
  switch (setup[1]) {
    case 1: /* CLEAR_FEATURE of an endpoint: its numbers begin anew */
      USB_EP(1) = (USB_EP(1) & (KEPT | 0x40)) | RX | TX;
      set_state(1, TX_STATE, TX_NAK);
      sends = 0;
      return acknowledge();
    case 5:
      new_address = setup[2];
      return acknowledge();
    case 6:
      return give_descriptor(setup[3], setup[2], setup[6] | (unsigned)setup[7] << 8);
    case 9:
      on_configured();
      return acknowledge();
    case 0x20:
      takes_coding = 1;
      return set_state(0, RX_STATE, RX_VALID);
    case 0x22:
      control_lines = setup[2];
      return acknowledge();
    default:
      refuse();
  }
}

static void on_control_received(void) {
  const int is_setup = (USB_EP(0) & SETUP) != 0;
  const unsigned count = received(0);
  uint8_t data[CONTROL_BYTES];
  for (unsigned i = 0; i < count; ++i) data[i] = byte_at(0x48 + i);
  clear_flag(0, RX);
  if (is_setup) return on_setup();
  if (takes_coding && count == sizeof line_coding) {
    takes_coding = 0;
    for (unsigned i = 0; i < count; ++i) line_coding[i] = data[i];
    return acknowledge();
  }
  set_state(0, RX_STATE, RX_VALID);
}

static void on_control_sent(void) {
  clear_flag(0, TX);
  if (new_address != 0) {
    USB_DADDR = 0x80 | new_address;
    new_address = 0;
  }
  if (answer_goes_on) send_answer();
}

static unsigned ring_used(void) { return (ring_head - ring_tail) % RING; }

static void add(uint8_t byte) {
  ring[ring_head] = byte;
  ring_head = (ring_head + 1) % RING;
}

static void send_more(void) {
  uint8_t packet[DATA_BYTES];
  unsigned count = 0;
  if (sends || (ring_used() == 0 && !ends_full_packet)) return;
  while (count < DATA_BYTES && ring_used() != 0) {
    packet[count++] = ring[ring_tail];
    ring_tail = (ring_tail + 1) % RING;
  }
  put(1, packet, count);
  sends = 1;
  ends_full_packet = ENDS_FULL_PACKETS && count == DATA_BYTES;
  set_state(1, TX_STATE, TX_VALID);
}

/* What a line of the host means; the image says. */
static void on_line(char first);

static void on_data_received(void) {
  static char first;
  static int is_inside;
  const unsigned count = received(1);
  clear_flag(1, RX);
  for (unsigned i = 0; i < count; ++i) {
    const uint8_t byte = byte_at(0xC0 + i);
    if (!is_inside) first = (char)byte;
    is_inside = byte != '\n';
    add(byte);
    if (byte != '\n') continue;
    GPIOA_ODR ^= 1U;
    on_line(first);
  }
  /* Flow control: no room for another packet and what a line adds. */
  holds_off = RING - ring_used() < 2 * DATA_BYTES;
  if (!holds_off) set_state(1, RX_STATE, RX_VALID);
  send_more();
}

static void on_data_sent(void) {
  clear_flag(1, TX);
  sends = 0;
  send_more();
  if (!holds_off || RING - ring_used() < 2 * DATA_BYTES) return;
  holds_off = 0;
  set_state(1, RX_STATE, RX_VALID);
}

void on_usb(void) {
  const uint32_t status = USB_ISTR;
  if (status & RESET) {
    USB_ISTR = ~(uint32_t)RESET;
    on_reset();
  }
  if (status & WKUP) {
    USB_CNTR &= ~(uint32_t)FSUSP;
    USB_ISTR = ~(uint32_t)WKUP;
  }
  if (status & SUSP) {
    ++suspends;
    USB_CNTR |= FSUSP;
    USB_ISTR = ~(uint32_t)SUSP;
    USB_CNTR |= LP_MODE;
  }
  while (USB_ISTR & CTR) {
    const uint32_t n = USB_ISTR & 0xFU;
    const uint32_t endpoint = USB_EP(n);
    if (endpoint & RX) n == 0 ? on_control_received() : on_data_received();
    if (endpoint & TX) n == 0 ? on_control_sent() : on_data_sent();
  }
}

void on_usb_wake(void) {
  EXTI_PR = 1U << 18;
  ++wakes;
}

static void usb_attach(void) {
  USB_CNTR = FRES;
  for (volatile int i = 0; i < 100; ++i) {
  }
  USB_CNTR = 0;
  USB_ISTR = 0;
  USB_CNTR = CTR | RESET | SUSP | WKUP;
}

static void usb_start(void) {
  set_clock();
  RCC_APB1ENR |= 1U << 23;
  set_outputs();
  EXTI_IMR = EXTI_RTSR = 1U << 18;
  enable_interrupt(IRQ_USB);
  enable_interrupt(IRQ_USB_WAKE);
  usb_attach();
}

#endif
