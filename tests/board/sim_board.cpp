// SPDX-License-Identifier: Apache-2.0
#include "tests/board/sim_board.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <string_view>
#include <system_error>
#include <utility>

namespace kerfbench::board {
namespace {

constexpr std::uint64_t kSecond_ns = 1'000'000'000;

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

SimBoard::SimBoard(const std::filesystem::path& chip, const std::map<Signal, unsigned>& lines,
                   std::filesystem::path tty)
    : tty_(std::move(tty)) {
  for (const auto& [signal, line] : lines) {
    const auto file = chip / fmt::format("sim_gpio{}", line) / (isSensor(signal) ? "value" : "pull");
    base::UniqueFd fd(::open(file.c_str(), (isSensor(signal) ? O_RDONLY : O_WRONLY) | O_CLOEXEC));
    if (!fd.valid()) fail(file.string());
    files_.emplace(signal, std::move(fd));
  }
  int board = -1;
  int bench = -1;
  std::array<char, 64> name{};
  termios raw{};
  ::cfmakeraw(&raw);
  if (::openpty(&board, &bench, name.data(), &raw, nullptr) != 0) fail("a terminal for the UART");
  uart_ = base::UniqueFd(board);
  bench_end_ = base::UniqueFd(bench);
  ::fcntl(board, F_SETFL, O_NONBLOCK);
  std::error_code none;
  std::filesystem::remove(tty_, none);
  std::filesystem::create_symlink(name.data(), tty_);
}

SimBoard::~SimBoard() {
  std::error_code none;
  std::filesystem::remove(tty_, none);
}

std::uint64_t SimBoard::now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * kSecond_ns + static_cast<std::uint64_t>(now.tv_nsec);
}

void SimBoard::sleepUntil(std::uint64_t at_ns) {
  const timespec at{static_cast<time_t>(at_ns / kSecond_ns), static_cast<long>(at_ns % kSecond_ns)};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
}

bool SimBoard::level(Signal sensor) {
  char level = 0;
  if (::pread(files_.at(sensor).get(), &level, 1, 0) != 1) fail(std::string(signalName(sensor)));
  return level == '1';
}

void SimBoard::put(Signal output, bool level) {
  const std::string_view word = level ? "pull-up" : "pull-down";
  if (::pwrite(files_.at(output).get(), word.data(), word.size(), 0) < 0)
    fail(std::string(signalName(output)));
}

std::vector<std::uint8_t> SimBoard::receive() {
  std::vector<std::uint8_t> bytes(4096);
  const auto got = ::read(uart_.get(), bytes.data(), bytes.size());
  if (got < 0 && errno != EAGAIN && errno != EINTR) fail("the UART");
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

void SimBoard::send(std::span<const std::uint8_t> bytes) {
  unsent_.insert(unsent_.end(), bytes.begin(), bytes.end());
  const auto sent = ::write(uart_.get(), unsent_.data(), unsent_.size());
  if (sent < 0 && errno != EAGAIN && errno != EINTR) fail("the UART");
  if (sent > 0) unsent_.erase(unsent_.begin(), unsent_.begin() + sent);
}

}  // namespace kerfbench::board
