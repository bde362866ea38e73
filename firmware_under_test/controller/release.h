/* SPDX-License-Identifier: Apache-2.0 */
/* Description of a release: a block of bytes that lies unchanged in each image, so that a planner can plan
 * for the controller named by its image. INFO repeats it, so that the host can tell whether this is the
 * controller that it planned for.
 *
 * All integers little-endian, times in CPU cycles:
 *
 * -  0  magic "KERFREL", then the layout, KB_RELEASE_LAYOUT
 * -  8  u8 protocol version
 * -  9  u32 CPU clock, Hz
 * - 13  u16 cycles of a tick
 * - 15  u8 ticks of a period
 * - 16  u8 steps of an axis in a period, at most
 * - 17  u16 queue size; one byte less can be filled
 * - 19  u32 baud
 * - 23  u16 longest gate delay, ticks
 * - 25  u16 × 4 shortest times of PUL and DIR: DIR stable before PUL's edge and after it, PUL active, PUL
 *       idle
 * - 33  u16 longest lateness of a tick
 * - 35  char[12] name of the time base, padded with zeros
 * - 47  char[32] version of the release, padded with zeros
 */
#ifndef KERFBENCH_CONTROLLER_RELEASE_H
#define KERFBENCH_CONTROLLER_RELEASE_H

#include <stdint.h>

/* Where the processor has a space of its own for code, the block must not be copied to RAM. */
#ifdef __SDCC
#define KB_IN_CODE __code
#else
#define KB_IN_CODE
#endif

#define KB_RELEASE_MAGIC "KERFREL"
#define KB_RELEASE_LAYOUT 1
#define KB_RELEASE_NAME_LEN 12
#define KB_RELEASE_VERSION_LEN 32
#define KB_RELEASE_LEN (47 + KB_RELEASE_VERSION_LEN)

#ifdef __cplusplus
extern "C" {
#endif
struct kb_release {
  char magic[sizeof(KB_RELEASE_MAGIC) - 1];
  uint8_t numbers[28];
  char name[KB_RELEASE_NAME_LEN];
  char version[KB_RELEASE_VERSION_LEN];
};
extern KB_IN_CODE const struct kb_release kb_release;
#ifdef __cplusplus
}
#endif

#endif
