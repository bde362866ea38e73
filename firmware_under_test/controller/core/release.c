/* SPDX-License-Identifier: Apache-2.0 */
#include "firmware_under_test/controller/release.h"

#include "firmware_under_test/controller/protocol.h"

#ifndef KB_VERSION
#define KB_VERSION "unversioned"
#endif

#define U16(value) (uint8_t)((value)&0xFFU), (uint8_t)((value) >> 8 & 0xFFU)
#define U32(value) U16((value)&0xFFFFU), U16((value) >> 16 & 0xFFFFU)

_Static_assert(sizeof(KB_TARGET_NAME) <= KB_RELEASE_NAME_LEN, "the name is too long");
_Static_assert(sizeof(KB_VERSION) <= KB_RELEASE_VERSION_LEN, "the version is too long");

_Static_assert(sizeof(struct kb_release) == KB_RELEASE_LEN, "bytes without gaps");

#ifdef __GNUC__
__attribute__((used))
#endif
KB_IN_CODE const struct kb_release kb_release = {
    KB_RELEASE_MAGIC,
    {KB_RELEASE_LAYOUT, KB_PROTOCOL_VERSION, U32(KB_CPU_HZ), U16(KB_TICK_CYCLES), KB_TICKS_PER_PERIOD,
     KB_TICKS_PER_PERIOD - 1U, U16(KB_QUEUE_SIZE), U32(KB_BAUD), U16(KB_LONGEST_DELAY_TICKS),
     U16(KB_SETUP_CYCLES), U16(KB_HOLD_CYCLES), U16(KB_WIDTH_CYCLES), U16(KB_SPACE_CYCLES),
     U16(KB_LATE_CYCLES)},
    KB_TARGET_NAME,
    KB_VERSION,
};
