/* SPDX-License-Identifier: Apache-2.0 */
#include "message.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

#include "hil/source/pin_stream.h"

void kb_die(const char* why) {
  fprintf(stderr, "controller-native: %s\n", why);
  exit(2);
}

void kb_buffer_free(struct kb_buffer* buffer) {
  free(buffer->bytes);
  memset(buffer, 0, sizeof(*buffer));
}

static void reserve(struct kb_buffer* buffer, size_t more) {
  if (buffer->capacity - buffer->size >= more) {
    return;
  }
  const size_t capacity = 2 * (buffer->size + more);
  uint8_t* const bytes = realloc(buffer->bytes, capacity);
  if (bytes == NULL) {
    kb_die("out of memory");
  }
  buffer->bytes = bytes;
  buffer->capacity = capacity;
}

void kb_put_bytes(struct kb_buffer* buffer, const uint8_t* bytes, size_t size) {
  if (size == 0) {
    return;
  }
  reserve(buffer, size);
  memcpy(buffer->bytes + buffer->size, bytes, size);
  buffer->size += size;
}

void kb_put_uint(struct kb_buffer* buffer, uint64_t value, unsigned bytes) {
  uint8_t little[8];
  for (unsigned i = 0; i < bytes; ++i) {
    little[i] = (uint8_t)(value >> (8 * i));
  }
  kb_put_bytes(buffer, little, bytes);
}

void kb_put_text(struct kb_buffer* buffer, const char* text) {
  const size_t size = strlen(text);
  kb_put_uint(buffer, size, 2);
  kb_put_bytes(buffer, (const uint8_t*)text, size);
}

uint64_t kb_get_uint(struct kb_buffer* buffer, unsigned bytes) {
  if (buffer->size - buffer->read < bytes) {
    buffer->short_read = true;
    buffer->read = buffer->size;
    return 0;
  }
  uint64_t value = 0;
  for (unsigned i = 0; i < bytes; ++i) {
    value |= (uint64_t)buffer->bytes[buffer->read++] << (8 * i);
  }
  return value;
}

void kb_skip_text(struct kb_buffer* buffer) {
  const size_t size = (size_t)kb_get_uint(buffer, 2);
  if (buffer->size - buffer->read < size) {
    buffer->short_read = true;
    buffer->read = buffer->size;
    return;
  }
  buffer->read += size;
}

/* What one read() has brought: mostly all requests of a quantum. */
static struct {
  uint8_t bytes[65536];
  size_t begin, end;
} fetched;

/* False at the end of the stream. */
static bool fetch(void) {
  ssize_t got;
  do {
    got = read(STDIN_FILENO, fetched.bytes, sizeof(fetched.bytes));
  } while (got < 0 && errno == EINTR);
  if (got < 0) {
    kb_die(strerror(errno));
  }
  fetched.begin = 0;
  fetched.end = (size_t)got;
  return got > 0;
}

/* Reads `size` bytes; 0 at a clean end before the first byte. */
static size_t readAll(uint8_t* to, size_t size) {
  size_t done = 0;
  while (done < size) {
    if (fetched.begin == fetched.end && !fetch()) {
      if (done == 0) {
        return 0;
      }
      kb_die("the stream ends inside a message");
    }
    const size_t there = fetched.end - fetched.begin;
    const size_t taken = there < size - done ? there : size - done;
    memcpy(to + done, fetched.bytes + fetched.begin, taken);
    fetched.begin += taken;
    done += taken;
  }
  return done;
}

bool kb_read_message(uint8_t* type, struct kb_buffer* payload) {
  uint8_t head[5];
  if (readAll(head, sizeof(head)) == 0) {
    return false;
  }
  const uint32_t size =
      (uint32_t)head[0] | (uint32_t)head[1] << 8 | (uint32_t)head[2] << 16 | (uint32_t)head[3] << 24;
  if (size > KB_PS_MAX_PAYLOAD) {
    kb_die("a message is longer than the protocol allows");
  }
  *type = head[4];
  payload->size = 0;
  payload->read = 0;
  payload->short_read = false;
  reserve(payload, size);
  if (size != 0 && readAll(payload->bytes, size) == 0) {
    kb_die("the stream ends inside a message");
  }
  payload->size = size;
  return true;
}

/* All of `parts`, at once where the system takes it: whoever waits is woken once. */
static void writeAll(struct iovec* parts, int count) {
  while (count > 0) {
    ssize_t put = writev(STDOUT_FILENO, parts, count);
    if (put < 0 && errno == EINTR) {
      continue;
    }
    if (put < 0) {
      kb_die(strerror(errno));
    }
    for (; count > 0 && (size_t)put >= parts->iov_len; ++parts, --count) {
      put -= (ssize_t)parts->iov_len;
    }
    if (count > 0) {
      parts->iov_base = (uint8_t*)parts->iov_base + put;
      parts->iov_len -= (size_t)put;
    }
  }
}

void kb_write_message(uint8_t type, const struct kb_buffer* payload) {
  const size_t size = payload->size;
  uint8_t head[5] = {(uint8_t)size, (uint8_t)(size >> 8), (uint8_t)(size >> 16), (uint8_t)(size >> 24), type};
  struct iovec parts[2] = {{head, sizeof(head)}, {payload->bytes, size}};
  writeAll(parts, 2);
}
