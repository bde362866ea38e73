// SPDX-License-Identifier: Apache-2.0
#include "hil/base/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "hil/base/colour.h"
#include "hil/base/terminal.h"

namespace kerfbench::base {

namespace {

/// Programs that watch a run need no more than a few words a second.
constexpr std::chrono::milliseconds kBetweenTold{100};
constexpr std::chrono::seconds kBetweenLogged{10};

/// Bytes of text in which an amount changes and the rest stays.
std::string withoutDigits(const std::string& text) {
  std::string rest;
  for (const char c : text)
    if (c < '0' || c > '9') rest += c;
  return rest;
}

}  // namespace

Console::Console(bool quiet, const std::filesystem::path& events)
    : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {
  if (!events.empty()) events_ = std::make_unique<EventLog>(events);
}

Console::~Console() { endProgress(); }

void Console::say(const std::string& line) {
  if (!quiet_) result(line);
}

void Console::result(const std::string& line) {
  endProgress();
  toTerminalAsItIs(stdout, withVerdictsInColour(forTerminal(line), stdout) + "\n");
  std::fflush(stdout);
}

void Console::progress(double now_s, const std::string& what) {
  if (events_) tellProgress(now_s, what);
  if (quiet_ || (!terminal_ && !verbose_)) return;
  const auto now = std::chrono::steady_clock::now();
  const bool is_timed = now_s >= 0.0 && expected_s_ > 0.0;
  const std::string kind = withoutDigits(what);
  const std::optional<double> share =
      is_timed ? std::optional(std::min(now_s / expected_s_, 1.0)) : shareIn(what);
  std::string text = now_s < 0 ? what : fmt::format("{:7.2f} s  {}", now_s, what);
  if (is_timed && !shareIn(what)) text += fmt::format(", {:.0f} %", std::floor(100.0 * *share));
  if (share) {
    if (const auto left_s = left_.after(is_timed ? "run" : kind, *share, now))
      text += fmt::format(", about {} s left", *left_s);
  }
  if (!terminal_) {
    // A log gets a line when another work begins, and now and then.
    if (kind == logged_ && now < next_logged_) return;
    logged_ = kind;
    next_logged_ = now + kBetweenLogged;
    toTerminal(stderr, fmt::format("  {}\n", text));
    return;
  }
  toTerminalAsItIs(stderr, fmt::format("\r\033[K  {:.110}", forTerminal(text)));
  std::fflush(stderr);
  progress_shown_ = true;
}

void Console::tellProgress(double now_s, const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  std::string kind = withoutDigits(what);
  if (kind == told_what_ && now < next_told_) return;
  told_what_ = std::move(kind);
  next_told_ = now + kBetweenTold;
  if (now_s < 0.0)
    events_->tell("progress", {{"what", what}});
  else if (expected_s_ > 0.0)
    events_->tell("progress",
                  {{"now_s", now_s}, {"share", std::min(now_s / expected_s_, 1.0)}, {"what", what}});
  else
    events_->tell("progress", {{"now_s", now_s}, {"what", what}});
}

void Console::event(std::string_view name, std::initializer_list<EventField> fields) {
  if (events_) events_->tell(name, fields);
}

void Console::endProgress() {
  if (!progress_shown_) return;
  toTerminalAsItIs(stderr, "\r\033[K");
  progress_shown_ = false;
}

ProgressFn progressOn(Console& console) {
  return [&console](double now_s, const std::string& what) { console.progress(now_s, what); };
}

}  // namespace kerfbench::base
