/* SPDX-License-Identifier: Apache-2.0 */
/* Functions of libgpiod 2 that the bench calls, declared for the machine that has 1.6: the adapter is
 * compiled and tested on both. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

struct gpiod_chip;
struct gpiod_chip_info;
struct gpiod_line_info;

enum gpiod_line_direction {
  GPIOD_LINE_DIRECTION_AS_IS = 1,
  GPIOD_LINE_DIRECTION_INPUT = 2,
  GPIOD_LINE_DIRECTION_OUTPUT = 3
};

struct gpiod_chip* gpiod_chip_open(const char* path);
void gpiod_chip_close(struct gpiod_chip* chip);

struct gpiod_chip_info* gpiod_chip_get_info(struct gpiod_chip* chip);
void gpiod_chip_info_free(struct gpiod_chip_info* info);
const char* gpiod_chip_info_get_name(struct gpiod_chip_info* info);
const char* gpiod_chip_info_get_label(struct gpiod_chip_info* info);
size_t gpiod_chip_info_get_num_lines(struct gpiod_chip_info* info);

struct gpiod_line_info* gpiod_chip_get_line_info(struct gpiod_chip* chip, unsigned int offset);
void gpiod_line_info_free(struct gpiod_line_info* info);
unsigned int gpiod_line_info_get_offset(struct gpiod_line_info* info);
const char* gpiod_line_info_get_name(struct gpiod_line_info* info);
const char* gpiod_line_info_get_consumer(struct gpiod_line_info* info);
bool gpiod_line_info_is_used(struct gpiod_line_info* info);
bool gpiod_line_info_is_active_low(struct gpiod_line_info* info);
enum gpiod_line_direction gpiod_line_info_get_direction(struct gpiod_line_info* info);

#ifdef __cplusplus
}
#endif
