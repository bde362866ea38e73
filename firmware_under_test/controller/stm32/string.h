/* SPDX-License-Identifier: Apache-2.0 */
/* What the core needs of the C library, which a release without one brings along (startup.c). */
#ifndef KERFBENCH_CONTROLLER_STRING_H
#define KERFBENCH_CONTROLLER_STRING_H

#include <stddef.h>

void* memcpy(void* restrict to, const void* restrict from, size_t size);
void* memmove(void* to, const void* from, size_t size);
void* memset(void* to, int value, size_t size);
int memcmp(const void* a, const void* b, size_t size);

#endif
