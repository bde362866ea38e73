// SPDX-License-Identifier: Apache-2.0
#include "hil/source/serial/serial_line.h"

#include <asm/termbits.h>
#include <fmt/format.h>
#include <sys/ioctl.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

namespace kerfbench::source {
namespace {

std::string openWords(int error) {
  switch (error) {
    case ENOENT:
      return "no such serial line";
    case EACCES:
    case EPERM:
      return "not allowed; put yourself into the group that `ls -l` names (on Debian dialout)";
    case EBUSY:
      return "another program has the line";
    case ENODEV:
    case ENXIO:
      return "the serial line has gone";
    default:
      return "cannot be opened: " + std::generic_category().message(error);
  }
}

}  // namespace

SerialLine::SerialLine(std::shared_ptr<SerialSystem> system, std::string path, std::uint32_t baud)
    : system_(std::move(system)), path_(std::move(path)) {
  const SerialAnswer opened = system_->open(path_);
  if (opened.failed()) throw SerialError(path_ + ": " + openWords(opened.error));
  fd_ = SerialFd(static_cast<int>(opened.value), {system_});
  try {
    configure(baud);
  } catch (...) {
    allowOthers();
    throw;
  }
}

SerialLine::~SerialLine() { allowOthers(); }

void SerialLine::allowOthers() {
  // The next program may have the line again: the mark outlives close() while anybody has the line open.
  if (is_alone_) (void)system_->control(fd_.get(), TIOCNXCL, nullptr);
}

void SerialLine::configure(std::uint32_t baud) {
  termios2 settings{};
  const SerialAnswer known = system_->control(fd_.get(), TCGETS2, &settings);
  if (known.failed()) {
    if (known.error == ENOTTY || known.error == EINVAL) throw SerialError(path_ + ": is no serial line");
    fail("does not tell its settings", known.error);
  }
  const SerialAnswer alone = system_->control(fd_.get(), TIOCEXCL, nullptr);
  if (alone.failed()) fail("cannot be had alone", alone.error);
  is_alone_ = true;
  settings.c_iflag = IGNBRK | IGNPAR;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
  settings.c_ispeed = settings.c_ospeed = baud;
  // With O_NONBLOCK and one byte to wait for, "nothing there" is EAGAIN and 0 is the end of the line.
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  const SerialAnswer set = system_->control(fd_.get(), TCSETS2, &settings);
  if (set.failed()) fail(fmt::format("cannot be set to {} baud", baud), set.error);
  // The call succeeds if any one setting could be made.
  const SerialAnswer again = system_->control(fd_.get(), TCGETS2, &settings);
  if (again.failed()) fail("does not tell its settings", again.error);
  if (std::abs(static_cast<double>(settings.c_ospeed) - baud) > kMaxBaudError * baud) {
    throw SerialError(
        fmt::format("{}: runs at {} baud where {} were asked for", path_, settings.c_ospeed, baud));
  }
  discard();
}

void SerialLine::discard() {
  // TCIFLUSH is passed by value, not by address.
  const SerialAnswer flushed = system_->control(fd_.get(), TCFLSH, reinterpret_cast<void*>(TCIFLUSH));
  if (flushed.failed()) fail("cannot be emptied", flushed.error);
}

void SerialLine::pump(std::vector<std::uint8_t>& received) {
  send();
  receive(received);
}

void SerialLine::send() {
  while (!waiting_.empty()) {
    const SerialAnswer sent = system_->write(fd_.get(), std::as_bytes(std::span(waiting_)));
    if (sent.failed()) {
      if (sent.error == EAGAIN) return;
      if (sent.error == EINTR) continue;
      fail("can no longer be written", sent.error);
    }
    waiting_.erase(waiting_.begin(), waiting_.begin() + sent.value);
  }
}

void SerialLine::receive(std::vector<std::uint8_t>& received) {
  std::array<std::uint8_t, 4096> bytes{};
  for (;;) {
    const SerialAnswer got = system_->read(fd_.get(), std::as_writable_bytes(std::span(bytes)));
    if (got.failed() && got.error == EINTR) continue;
    if (got.failed() && got.error == EAGAIN) return;
    if (got.failed() && got.error != EIO) fail("can no longer be read", got.error);
    if (got.value <= 0) throw SerialError(path_ + ": the other end has hung up");
    received.insert(received.end(), bytes.begin(), bytes.begin() + got.value);
    if (static_cast<std::size_t>(got.value) < bytes.size()) return;
  }
}

void SerialLine::fail(const std::string& what, int error) const {
  throw SerialError(fmt::format("{}: {}: {}", path_, what, std::generic_category().message(error)));
}

}  // namespace kerfbench::source
