// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/line_request.h"

#include <fmt/format.h>
#include <linux/gpio.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "hil/source/gpio/words.h"

namespace kerfbench::source {
LineRequest::LineRequest(std::shared_ptr<GpioSystem> system, const std::filesystem::path& chip,
                         std::vector<ChipLine> lines)
    : system_(std::move(system)), chip_(chip.string()), lines_(std::move(lines)) {
  if (lines_.size() < 2 || lines_.size() > GPIO_V2_LINES_MAX) {
    throw GpioError(fmt::format(
        "{}: {} lines were asked for, and it must be 2 to {}: on a line of its own edges that the kernel "
        "merges leave no gap in its numbers",
        chip_, lines_.size(), GPIO_V2_LINES_MAX));
  }
  chip_fd_ = openChipLines(system_, chip_, lines_);
  request();
}

void LineRequest::request() {
  gpio_v2_line_request request{};
  for (std::size_t i = 0; i < lines_.size(); ++i) request.offsets[i] = lines_[i].offset;
  std::memcpy(request.consumer, kGpioConsumer, sizeof kGpioConsumer);
  request.config.flags =
      GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING;
  request.num_lines = static_cast<std::uint32_t>(lines_.size());
  request.event_buffer_size = kEventBuffer;
  const KernelAnswer granted = system_->control(chip_fd_.get(), GPIO_V2_GET_LINE_IOCTL, &request);
  if (granted.failed()) throw GpioError(requestWords(chip_, granted.error));
  fd_ = GpioFd(request.fd, {system_});
}

void LineRequest::gone(int error) const { throw GpioError(readWords(chip_, error)); }

bool LineRequest::read(std::chrono::nanoseconds timeout, std::vector<KernelEdge>& edges) {
  short revents = 0;
  const KernelAnswer ready = system_->poll(fd_.get(), static_cast<std::uint64_t>(timeout.count()), revents);
  if (ready.failed() && ready.error != EINTR) gone(ready.error);
  if (ready.value <= 0) return false;
  if ((revents & POLLIN) == 0) gone((revents & (POLLERR | POLLHUP | POLLNVAL)) != 0 ? ENODEV : EIO);

  std::array<gpio_v2_line_event, kMostAtOnce> events{};
  const KernelAnswer got = system_->read(fd_.get(), std::as_writable_bytes(std::span(events)));
  if (got.failed()) {
    if (got.error == EINTR || got.error == EAGAIN) return false;
    gone(got.error);
  }
  const auto bytes = static_cast<std::size_t>(got.value);
  if (bytes == 0 || bytes % sizeof events[0] != 0)
    throw GpioError(
        fmt::format("{}: the kernel gave {} bytes, which is no whole number of edges", chip_, bytes));
  for (const gpio_v2_line_event& event : std::span(events).first(bytes / sizeof events[0])) {
    const auto line = std::ranges::find(lines_, event.offset, &ChipLine::offset);
    const bool rising = event.id == GPIO_V2_LINE_EVENT_RISING_EDGE;
    if (line == lines_.end() || (!rising && event.id != GPIO_V2_LINE_EVENT_FALLING_EDGE)) {
      throw GpioError(
          fmt::format("{}: the kernel tells of an edge of kind {} on line {}, which nobody asked for", chip_,
                      event.id, event.offset));
    }
    edges.push_back({event.timestamp_ns, static_cast<std::size_t>(line - lines_.begin()), rising, event.seqno,
                     event.line_seqno});
  }
  return true;
}

std::vector<bool> LineRequest::levels() {
  gpio_v2_line_values values{};
  values.mask =
      lines_.size() == GPIO_V2_LINES_MAX ? ~std::uint64_t{0} : (std::uint64_t{1} << lines_.size()) - 1;
  const KernelAnswer known = system_->control(fd_.get(), GPIO_V2_LINE_GET_VALUES_IOCTL, &values);
  if (known.failed()) gone(known.error);
  std::vector<bool> levels(lines_.size());
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = (values.bits >> i & 1U) != 0;
  return levels;
}

std::string edgeTrouble(GpioSystem& system, const std::filesystem::path& chip) {
  const KernelAnswer opened = system.open(chip.string());
  if (opened.failed()) return openWords(chip.string(), opened.error);
  gpio_v2_line_info info{};
  const KernelAnswer known = system.control(opened.value, GPIO_V2_GET_LINEINFO_IOCTL, &info);
  system.close(opened.value);
  return known.failed() ? lineInfoWords(chip.string(), known.error) : "";
}

}  // namespace kerfbench::source
