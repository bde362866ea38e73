/* SPDX-License-Identifier: Apache-2.0 */
/* Vector table and start, without vendor code, and what the compiler and the core need of a C library. */
#include <stddef.h>
#include <stdint.h>

#include "string.h"

extern uint32_t kb_stack_top, kb_data_begin, kb_data_end, kb_data_image, kb_bss_begin, kb_bss_end;
int main(void);
void kb_on_tick(void);
void kb_on_encoder(void);
void kb_on_mark(void);
void kb_on_byte(void);
void kb_start(void);

/* Stays here until the watchdog resets: nothing that is not expected goes on. */
static void unexpected(void) {
  for (;;) {
  }
}

__attribute__((section(".vectors"), used)) static const void* const kVectors[16 + 43] = {
    [0] = &kb_stack_top,    [1] = kb_start,         [2] = unexpected,         [3] = unexpected,
    [4] = unexpected,       [5] = unexpected,       [6] = unexpected,         [11] = unexpected,
    [14] = unexpected,      [15] = unexpected,      [16 + 6] = kb_on_encoder, [16 + 23] = kb_on_mark,
    [16 + 28] = kb_on_tick, [16 + 37] = kb_on_byte,
};

void kb_start(void) {
  memcpy(&kb_data_begin, &kb_data_image, (uintptr_t)&kb_data_end - (uintptr_t)&kb_data_begin);
  memset(&kb_bss_begin, 0, (uintptr_t)&kb_bss_end - (uintptr_t)&kb_bss_begin);
  (void)main();
  unexpected();
}

__attribute__((used)) void* memcpy(void* restrict to, const void* restrict from, size_t size) {
  unsigned char* target = to;
  const unsigned char* source = from;
  while (size-- > 0) {
    *target++ = *source++;
  }
  return to;
}

__attribute__((used)) void* memmove(void* to, const void* from, size_t size) {
  unsigned char* target = to;
  const unsigned char* source = from;
  if ((uintptr_t)target <= (uintptr_t)source) {
    return memcpy(to, from, size);
  }
  while (size-- > 0) {
    target[size] = source[size];
  }
  return to;
}

__attribute__((used)) void* memset(void* to, int value, size_t size) {
  unsigned char* target = to;
  while (size-- > 0) {
    *target++ = (unsigned char)value;
  }
  return to;
}

__attribute__((used)) int memcmp(const void* a, const void* b, size_t size) {
  const unsigned char* left = a;
  const unsigned char* right = b;
  for (; size > 0; --size, ++left, ++right) {
    if (*left != *right) {
      return *left < *right ? -1 : 1;
    }
  }
  return 0;
}
