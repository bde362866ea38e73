/* SPDX-License-Identifier: Apache-2.0 */
#include "queue.h"

#include "firmware_under_test/controller/protocol.h"

enum { KB_QUEUE_MASK = KB_QUEUE_SIZE - 1U };

static uint8_t queue[KB_QUEUE_SIZE];
static uint16_t queue_first;
static uint16_t queue_end;

void kb_queue_clear(void) { queue_first = queue_end = 0; }
uint16_t kb_queue_free(void) { return (uint16_t)((queue_first - queue_end - 1U) & KB_QUEUE_MASK); }
uint16_t kb_queue_used(void) { return (uint16_t)((queue_end - queue_first) & KB_QUEUE_MASK); }
bool kb_queue_empty(void) { return queue_first == queue_end; }

uint16_t kb_queue_end(uint8_t offset) { return (uint16_t)((queue_end + offset) & KB_QUEUE_MASK); }
uint16_t kb_queue_store(uint16_t at, uint8_t byte) {
  queue[at] = byte;
  return (uint16_t)((at + 1U) & KB_QUEUE_MASK);
}
void kb_queue_put(uint8_t offset, uint8_t byte) { queue[kb_queue_end(offset)] = byte; }
void kb_queue_commit(uint8_t length) { queue_end = kb_queue_end(length); }

uint8_t kb_queue_peek(uint8_t offset) { return queue[(queue_first + offset) & KB_QUEUE_MASK]; }
void kb_queue_drop(uint8_t length) { queue_first = (uint16_t)((queue_first + length) & KB_QUEUE_MASK); }
