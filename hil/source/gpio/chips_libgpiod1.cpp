// SPDX-License-Identifier: Apache-2.0
// readChip() by libgpiod 1.6, Debian 12's.
#include <gpiod.h>

#include <cerrno>
#include <memory>

#include "hil/source/gpio/chips.h"
#include "hil/source/gpio/words.h"

namespace kerfbench::source {
namespace {

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};

std::string textOf(const char* text) { return text == nullptr ? "" : text; }

GpioLineInfo infoOf(gpiod_line* line) {
  GpioLineInfo info;
  info.offset = gpiod_line_offset(line);
  info.name = textOf(gpiod_line_name(line));
  info.consumer = textOf(gpiod_line_consumer(line));
  info.used = gpiod_line_is_used(line);
  info.output = gpiod_line_direction(line) == GPIOD_LINE_DIRECTION_OUTPUT;
  info.active_low = gpiod_line_active_state(line) == GPIOD_LINE_ACTIVE_STATE_LOW;
  return info;
}

}  // namespace

GpioChipInfo readChip(const std::filesystem::path& path) {
  const std::unique_ptr<gpiod_chip, CloseChip> chip(gpiod_chip_open(path.c_str()));
  // ENOTTY: libgpiod's word for a file that is no gpiochip's.
  if (!chip) {
    const int error = errno;
    throw GpioError(error == ENOTTY || error == EINVAL ? chipWords(path.string(), error)
                                                       : openWords(path.string(), error));
  }
  GpioChipInfo info{path, textOf(gpiod_chip_name(chip.get())), textOf(gpiod_chip_label(chip.get())), {}};
  const unsigned count = gpiod_chip_num_lines(chip.get());
  for (unsigned offset = 0; offset < count; ++offset) {
    gpiod_line* const line = gpiod_chip_get_line(chip.get(), offset);
    if (line == nullptr) throw GpioError(lineInfoWords(path.string(), errno));
    info.lines.push_back(infoOf(line));
  }
  return info;
}

}  // namespace kerfbench::source
