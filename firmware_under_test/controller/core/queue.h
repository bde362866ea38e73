/* SPDX-License-Identifier: Apache-2.0 */
/* Ring of program bytes between frames and interpreter. Bytes are put behind the end and count only once
 * committed, so that a frame with a bad CRC leaves no trace. */
#ifndef KERFBENCH_CONTROLLER_QUEUE_H
#define KERFBENCH_CONTROLLER_QUEUE_H

#include <stdbool.h>
#include <stdint.h>

void kb_queue_clear(void);
uint16_t kb_queue_free(void);
uint16_t kb_queue_used(void);
bool kb_queue_empty(void);

void kb_queue_put(uint8_t offset, uint8_t byte);
/* Place `offset` bytes behind the end. kb_queue_store() stores a byte there and returns the next place. */
uint16_t kb_queue_end(uint8_t offset);
uint16_t kb_queue_store(uint16_t at, uint8_t byte);
void kb_queue_commit(uint8_t length);

/* Byte at `offset` from the start of the committed bytes. */
uint8_t kb_queue_peek(uint8_t offset);
void kb_queue_drop(uint8_t length);

#endif
