// SPDX-License-Identifier: Apache-2.0
#include "hil/base/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace kerfbench::base {

Console::Console(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

Console::~Console() { endProgress(); }

void Console::say(const std::string& line) {
  if (!quiet_) result(line);
}

void Console::result(const std::string& line) {
  endProgress();
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

void Console::progress(double now_s, const std::string& what) {
  if (quiet_ || !terminal_) return;
  const std::string text = now_s < 0 ? what : fmt::format("{:7.2f} s  {}", now_s, what);
  std::fputs(fmt::format("\r\033[K  {:.90}", text).c_str(), stderr);
  std::fflush(stderr);
  progress_shown_ = true;
}

void Console::endProgress() {
  if (!progress_shown_) return;
  std::fputs("\r\033[K", stderr);
  progress_shown_ = false;
}

ProgressFn progressOn(Console& console) {
  return [&console](double now_s, const std::string& what) { console.progress(now_s, what); };
}

}  // namespace kerfbench::base
