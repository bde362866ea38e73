// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/chip_lines.h"

#include <fmt/format.h>
#include <linux/gpio.h>

#include "hil/source/gpio/words.h"

namespace kerfbench::source {
namespace {

void checkChip(GpioSystem& system, int fd, const std::string& chip, const std::vector<ChipLine>& lines) {
  gpiochip_info info{};
  const KernelAnswer known = system.control(fd, GPIO_GET_CHIPINFO_IOCTL, &info);
  if (known.failed()) throw GpioError(chipWords(chip, known.error));
  for (const ChipLine& line : lines) {
    if (line.offset >= info.lines) {
      throw GpioError(fmt::format("{}: there is no line {} for {}, it has {} lines", chip, line.offset,
                                  line.name, info.lines));
    }
  }
}

// The kernel's answer to the request itself does not say which line is taken.
void checkFree(GpioSystem& system, int fd, const std::string& chip, const std::vector<ChipLine>& lines) {
  std::string taken;
  for (const ChipLine& line : lines) {
    gpio_v2_line_info info{};
    info.offset = line.offset;
    const KernelAnswer known = system.control(fd, GPIO_V2_GET_LINEINFO_IOCTL, &info);
    if (known.failed()) throw GpioError(lineInfoWords(chip, known.error));
    if ((info.flags & GPIO_V2_LINE_FLAG_USED) == 0) continue;
    info.consumer[GPIO_MAX_NAME_SIZE - 1] = 0;
    taken += fmt::format("{}{}", taken.empty() ? "" : "\n",
                         takenWords(chip, line.offset, line.name, info.consumer));
  }
  if (!taken.empty()) throw GpioError(taken);
}

}  // namespace

GpioFd openChipLines(const std::shared_ptr<GpioSystem>& system, const std::string& chip,
                     const std::vector<ChipLine>& lines) {
  const KernelAnswer opened = system->open(chip);
  if (opened.failed()) throw GpioError(openWords(chip, opened.error));
  GpioFd fd(opened.value, {system});
  checkChip(*system, fd.get(), chip, lines);
  checkFree(*system, fd.get(), chip, lines);
  return fd;
}

}  // namespace kerfbench::source
