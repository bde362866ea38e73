// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/output_lines.h"

#include <fmt/format.h>
#include <linux/gpio.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "hil/source/gpio/words.h"

namespace kerfbench::source {

OutputLines::OutputLines(std::shared_ptr<GpioSystem> system, const std::filesystem::path& chip,
                         std::vector<ChipLine> lines, const std::vector<bool>& levels)
    : system_(std::move(system)), chip_(chip.string()), lines_(std::move(lines)) {
  if (lines_.empty() || lines_.size() > GPIO_V2_LINES_MAX) {
    throw GpioError(fmt::format("{}: {} lines were asked for as outputs, and it must be 1 to {}", chip_,
                                lines_.size(), GPIO_V2_LINES_MAX));
  }
  chip_fd_ = openChipLines(system_, chip_, lines_);
  gpio_v2_line_request request{};
  gpio_v2_line_config_attribute& at_first = request.config.attrs[0];
  at_first.attr.id = GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    request.offsets[i] = lines_[i].offset;
    at_first.mask |= std::uint64_t{1} << i;
    if (levels.at(i)) at_first.attr.values |= std::uint64_t{1} << i;
  }
  std::memcpy(request.consumer, kGpioConsumer, sizeof kGpioConsumer);
  request.config.flags = GPIO_V2_LINE_FLAG_OUTPUT;
  request.config.num_attrs = 1;
  request.num_lines = static_cast<std::uint32_t>(lines_.size());
  const KernelAnswer granted = system_->control(chip_fd_.get(), GPIO_V2_GET_LINE_IOCTL, &request);
  if (granted.failed()) throw GpioError(outputWords(chip_, granted.error));
  fd_ = GpioFd(request.fd, {system_});
}

void OutputLines::set(const std::vector<Change>& changes) {
  gpio_v2_line_values values{};
  for (const Change& change : changes) {
    const std::uint64_t bit = std::uint64_t{1} << change.line;
    values.mask |= bit;
    values.bits = change.level ? values.bits | bit : values.bits & ~bit;
  }
  KernelAnswer done = system_->control(fd_.get(), GPIO_V2_LINE_SET_VALUES_IOCTL, &values);
  while (done.failed() && done.error == EINTR)
    done = system_->control(fd_.get(), GPIO_V2_LINE_SET_VALUES_IOCTL, &values);
  if (done.failed()) throw GpioError(writeWords(chip_, done.error));
}

}  // namespace kerfbench::source
