/* SPDX-License-Identifier: Apache-2.0 */
/* Frames of protocol.h: from bytes, and to bytes. */
#ifndef KERFBENCH_CONTROLLER_FRAME_H
#define KERFBENCH_CONTROLLER_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware_under_test/controller/protocol.h"

enum { KB_SHORT_PAYLOAD = KB_CONFIG_LEN }; /* longest payload of all types but KB_DATA */

struct kb_frame {
  uint8_t type;
  uint8_t seq;
  uint8_t length;
  uint8_t nak;                       /* reason of a refusal, or 0 */
  uint8_t payload[KB_SHORT_PAYLOAD]; /* payload of all types but KB_DATA, whose bytes wait in the queue */
};

/* CRC-16/CCITT-FALSE, advanced by one byte. */
static inline uint16_t kb_crc16(uint16_t crc, uint8_t byte) {
  uint8_t high = (uint8_t)(crc >> 8);
  const uint8_t low = (uint8_t)crc;
  high ^= byte;
  high ^= (uint8_t)(high >> 4);
  const uint8_t new_high = (uint8_t)(low ^ (uint8_t)(high << 4) ^ (high >> 3));
  const uint8_t new_low = (uint8_t)(high ^ (uint8_t)(high << 5));
  return (uint16_t)((uint16_t)(new_high << 8) | new_low);
}

/* Job check of protocol.h. */
struct kb_check {
  uint16_t a;
  uint16_t b;
};

static inline void kb_check_add(struct kb_check* check, uint8_t byte) {
  check->a = (uint16_t)(check->a + byte);
  check->b = (uint16_t)(check->b + check->a);
}

/* Whether byte i of a received check is correct. */
static inline bool kb_check_holds(const struct kb_check* check, uint8_t i, uint8_t byte) {
#ifdef KB_DEFECT_CHECK_IGNORED
  /* Defect: "the CRC is enough". */
  (void)check;
  (void)i;
  (void)byte;
  return true;
#else
  const uint16_t half = i < 2 ? check->a : check->b;
  return byte == (uint8_t)((i & 1U) ? half >> 8 : half);
#endif
}

/* Check of all that was accepted so far. */
extern struct kb_check kb_job_check;

void kb_frame_init(void);
/* Takes one byte; true once a frame is complete, with or without a reason to refuse it. */
bool kb_frame_byte(uint8_t byte, struct kb_frame* frame);
/* Takes program bytes of a KB_DATA frame under way straight from the UART, at most `most`; returns their
 * number. The effect is that of kb_frame_byte() with each, in a third of the time: nearly all bytes of a job
 * come through this function. */
uint8_t kb_frame_take(uint8_t most);
/* Adds the program bytes of the last KB_DATA frame to kb_job_check. */
void kb_frame_commit(void);
/* Whether a frame is under way. */
bool kb_frame_begun(void);
/* Forgets a frame that was begun. */
void kb_frame_forget(void);

/* Sends when there is room for all of it; false: nothing was queued. */
bool kb_frame_send(uint8_t type, uint8_t seq, const uint8_t* payload, uint8_t length);
/* Moves at most one byte on to the UART. */
void kb_frame_pump(void);

#endif
