/* SPDX-License-Identifier: Apache-2.0 */
/* Child's end of hil/source/pin_stream.h: messages on descriptors 0 and 1. */
#ifndef KERFBENCH_CONTROLLER_NATIVE_MESSAGE_H
#define KERFBENCH_CONTROLLER_NATIVE_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Buffer of bytes that grows; also a cursor for reading. */
struct kb_buffer {
  uint8_t* bytes;
  size_t size;
  size_t capacity;
  size_t read;
  bool short_read; /* true if more was read than there was */
};

void kb_buffer_free(struct kb_buffer* buffer);
void kb_put_uint(struct kb_buffer* buffer, uint64_t value, unsigned bytes);
void kb_put_bytes(struct kb_buffer* buffer, const uint8_t* bytes, size_t size);
void kb_put_text(struct kb_buffer* buffer, const char* text);
uint64_t kb_get_uint(struct kb_buffer* buffer, unsigned bytes);
void kb_skip_text(struct kb_buffer* buffer);

/* False at the end of the stream; a broken stream ends the process. */
bool kb_read_message(uint8_t* type, struct kb_buffer* payload);
void kb_write_message(uint8_t type, const struct kb_buffer* payload);
_Noreturn void kb_die(const char* why);

#endif
