// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/source/serial/scripted_serial.h"

#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace kerfbench::source {
namespace {

SerialAnswer no(int error) { return {-1, error}; }

}  // namespace

SerialAnswer ScriptedSerial::open(const std::string& which) {
  path = which;
  if (open_error != 0) return no(open_error);
  ++lines_open;
  return {3, 0};
}

SerialAnswer ScriptedSerial::control(int /*fd*/, unsigned long request, void* argument) {
  switch (request) {
    case TCGETS2:
      if (get_error != 0) return no(get_error);
      static_cast<termios2*>(argument)->c_ospeed = runs_at_baud != 0 ? runs_at_baud : baud;
      return {};
    case TCSETS2:
      if (set_error != 0) return no(set_error);
      baud = static_cast<const termios2*>(argument)->c_ospeed;
      control_flags = static_cast<const termios2*>(argument)->c_cflag;
      return {};
    case TIOCEXCL:
    case TIOCNXCL:
      if (exclusive_error != 0) return no(exclusive_error);
      alone = request == TIOCEXCL;
      return {};
    case TCFLSH:
      if (flush_error != 0) return no(flush_error);
      to_bench.clear();
      return {};
    default:
      return no(ENOTTY);
  }
}

SerialAnswer ScriptedSerial::read(int /*fd*/, std::span<std::byte> into) {
  if (before_read) before_read();
  if (read_error != 0) return no(std::exchange(read_error, 0));
  if (to_bench.empty()) return hung_up ? SerialAnswer{} : no(EAGAIN);
  const std::size_t size = std::min(into.size(), to_bench.size());
  for (std::size_t i = 0; i < size; ++i) {
    into[i] = std::byte{to_bench.front()};
    to_bench.pop_front();
  }
  return {static_cast<long>(size), 0};
}

SerialAnswer ScriptedSerial::write(int /*fd*/, std::span<const std::byte> bytes) {
  if (write_error != 0) return no(std::exchange(write_error, 0));
  const std::size_t size =
      std::min(bytes.size(), std::exchange(takes, takes - std::min(bytes.size(), takes)));
  if (size == 0) return no(EAGAIN);
  for (const std::byte byte : bytes.first(size)) from_bench.push_back(std::to_integer<std::uint8_t>(byte));
  return {static_cast<long>(size), 0};
}

void ScriptedSerial::close(int /*fd*/) { --lines_open; }

}  // namespace kerfbench::source
