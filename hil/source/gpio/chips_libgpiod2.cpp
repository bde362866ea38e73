// SPDX-License-Identifier: Apache-2.0
// readChip() by libgpiod 2, where the distribution has it.
#include <gpiod.h>

#include <cerrno>
#include <memory>

#include "hil/source/gpio/chips.h"
#include "hil/source/gpio/words.h"

namespace kerfbench::source {
namespace {

struct Free {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
  void operator()(gpiod_chip_info* info) const { gpiod_chip_info_free(info); }
  void operator()(gpiod_line_info* info) const { gpiod_line_info_free(info); }
};

std::string textOf(const char* text) { return text == nullptr ? "" : text; }

GpioLineInfo infoOf(gpiod_line_info* line) {
  GpioLineInfo info;
  info.offset = gpiod_line_info_get_offset(line);
  info.name = textOf(gpiod_line_info_get_name(line));
  info.consumer = textOf(gpiod_line_info_get_consumer(line));
  info.used = gpiod_line_info_is_used(line);
  info.output = gpiod_line_info_get_direction(line) == GPIOD_LINE_DIRECTION_OUTPUT;
  info.active_low = gpiod_line_info_is_active_low(line);
  return info;
}

}  // namespace

GpioChipInfo readChip(const std::filesystem::path& path) {
  const std::unique_ptr<gpiod_chip, Free> chip(gpiod_chip_open(path.c_str()));
  if (!chip) {
    const int error = errno;
    // ENOTTY, EINVAL: libgpiod's words for a file that is no gpiochip's.
    throw GpioError(error == ENOTTY || error == EINVAL ? chipWords(path.string(), error)
                                                       : openWords(path.string(), error));
  }
  const std::unique_ptr<gpiod_chip_info, Free> about(gpiod_chip_get_info(chip.get()));
  if (!about) throw GpioError(chipWords(path.string(), errno));
  GpioChipInfo info{path,
                    textOf(gpiod_chip_info_get_name(about.get())),
                    textOf(gpiod_chip_info_get_label(about.get())),
                    {}};
  const auto count = static_cast<unsigned>(gpiod_chip_info_get_num_lines(about.get()));
  for (unsigned offset = 0; offset < count; ++offset) {
    const std::unique_ptr<gpiod_line_info, Free> line(gpiod_chip_get_line_info(chip.get(), offset));
    if (!line) throw GpioError(lineInfoWords(path.string(), errno));
    info.lines.push_back(infoOf(line.get()));
  }
  return info;
}

}  // namespace kerfbench::source
