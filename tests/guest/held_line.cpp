// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/held_line.h"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace kerfbench::guest {

HeldLine::HeldLine(const std::filesystem::path& chip, std::uint32_t line, const std::string& consumer) {
  gpio_v2_line_request request{};
  request.offsets[0] = line;
  request.num_lines = 1;
  request.config.flags = GPIO_V2_LINE_FLAG_INPUT;
  consumer.copy(request.consumer, sizeof(request.consumer) - 1);
  const int chip_fd = ::open(chip.c_str(), O_RDWR | O_CLOEXEC);
  const bool held = chip_fd >= 0 && ::ioctl(chip_fd, GPIO_V2_GET_LINE_IOCTL, &request) == 0;
  const int error = errno;
  if (chip_fd >= 0) ::close(chip_fd);
  if (!held) throw std::system_error(error, std::generic_category(), chip.string());
  fd_ = request.fd;
}

HeldLine::~HeldLine() { ::close(fd_); }

}  // namespace kerfbench::guest
