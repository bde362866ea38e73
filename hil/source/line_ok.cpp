// SPDX-License-Identifier: Apache-2.0
#include "hil/source/line_ok.h"

#include <algorithm>
#include <utility>

#include "hil/base/text.h"

namespace kerfbench::source {
namespace {

constexpr std::size_t kMaxReplyChars = 512;
constexpr std::size_t kMostKept = 32;  // Lines of a start that are kept.
constexpr double kProbeShare = 0.5;    // Share of the time to connect after which an empty line asks.
constexpr double kAskPeriod_s = 0.1;
constexpr double kReportTimeout_s = 1.0;  // Time after which a firmware without a report has none.

/// Code of a line, without comments "(…)" and "; …" and without blanks at the ends.
std::string strip(std::string_view line) {
  std::string out;
  bool in_comment = false;
  for (const char c : line) {
    if (c == ';') break;
    if (c == '(') in_comment = true;
    if (!in_comment) out += c;
    if (c == ')') in_comment = false;
  }
  const std::string_view code = base::trimmed(out);
  return code == "%" ? std::string() : std::string(code);
}

std::string shown(std::string_view line) { return base::printable(line, 80); }

bool isComplaint(std::string_view line) { return line.starts_with("error") || line.starts_with("ALARM"); }

}  // namespace

LineOkSender::LineOkSender(std::string_view program, const LineOkOptions& options) : options_(options) {
  for (std::size_t i = 0; i < options.setup.size(); ++i) {
    auto text = strip(options.setup[i]);
    if (!text.empty()) lines_.push_back({i + 1, std::move(text), true});
  }
  for (std::size_t number = 1; !program.empty(); ++number) {
    const auto eol = program.find('\n');
    auto text = strip(program.substr(0, eol));
    program.remove_prefix(eol == std::string_view::npos ? program.size() : eol + 1);
    if (!text.empty()) lines_.push_back({number, std::move(text), false});
  }
}

std::vector<std::uint8_t> LineOkSender::step(std::span<const std::uint8_t> received, double now_s) {
  if (!std::exchange(started_, true)) start_s_ = now_s;
  if (!received.empty()) {
    if (!std::exchange(heard_, true)) first_heard_s_ = now_s;
    heard_s_ = now_s;
  }
  for (const std::uint8_t byte : received) {
    if (state_ == State::kDone || state_ == State::kFailed) break;
    if (byte != '\n') {
      if (byte != '\r') partial_ += static_cast<char>(byte);
      if (partial_.size() > kMaxReplyChars) fail("the firmware sends an endless line: wrong baud rate?");
      continue;
    }
    const std::string line = std::exchange(partial_, {});
    if (!line.empty()) takeLine(line, now_s);
  }
  watchTime(now_s);
  return std::exchange(outgoing_, {});
}

void LineOkSender::takeLine(std::string_view line, double now_s) {
  switch (state_) {
    case State::kConnecting:
      takeBootLine(line);
      break;
    case State::kStreaming:
    case State::kDraining:
      takeAnswer(line, now_s);
      break;
    case State::kDone:
    case State::kFailed:
      break;
  }
}

void LineOkSender::takeBootLine(std::string_view line) {
  if (isComplaint(line)) {
    if (complaints_.size() < kMostKept) complaints_.push_back(shown(line));
  } else if (line != "ok" && line.find_first_of("<[$") != 0 && greeting_.size() < kMostKept) {
    ++greeting_[std::string(line)];
  }
}

void LineOkSender::takeAnswer(std::string_view line, double now_s) {
  if (line.starts_with("ALARM")) return fail("the firmware reports " + shown(line) + atLine());
  if (line.starts_with("error")) return fail("the firmware answers " + shown(line) + atLine());
  if (const auto said = greeting_.find(line); said != greeting_.end() && said->second == 1)
    return fail("the firmware has started again: it says \"" + shown(line) + "\"" + atLine());
  if (line.find("busy") != std::string_view::npos) waiting_since_s_ = now_s;
  if (state_ == State::kDraining) {
    if (line.starts_with("<")) takeReport(line);
    return;
  }
  if (line != "ok" || answered_ == sent_) return;
  in_flight_bytes_ -= lines_[answered_].text.size() + 1;
  ++answered_;
  waiting_since_s_ = now_s;
  sendMore(now_s);
}

void LineOkSender::takeReport(std::string_view report) {
  report_seen_ = true;
  if (report.starts_with("<Idle")) {
    idle_seen_ = true;
    state_ = State::kDone;
  } else if (report.starts_with("<Alarm")) {
    fail("the firmware is in alarm after the last line: " + shown(report));
  }
}

void LineOkSender::watchTime(double now_s) {
  switch (state_) {
    case State::kConnecting:
      watchStart(now_s);
      break;
    case State::kStreaming:
      if (now_s - waiting_since_s_ >= options_.reply_timeout_s) {
        fail("no answer in " + std::to_string(options_.reply_timeout_s) + " s" + atLine());
      }
      break;
    case State::kDraining:
      if (!report_seen_ && now_s - drain_s_ >= kReportTimeout_s) {
        state_ = State::kDone;
      } else if (now_s - drain_s_ >= options_.drain_timeout_s) {
        fail("the firmware has not come to rest in " + std::to_string(options_.drain_timeout_s) + " s");
      } else if (now_s - asked_s_ >= kAskPeriod_s) {
        asked_s_ = now_s;
        put("?");
      }
      break;
    case State::kDone:
    case State::kFailed:
      break;
  }
}

void LineOkSender::watchStart(double now_s) {
  // One that never stops talking is spoken to all the same.
  const bool is_quiet = heard_ && now_s - heard_s_ >= options_.quiet_s;
  if (is_quiet || (heard_ && now_s - first_heard_s_ >= options_.connect_timeout_s)) {
    partial_.clear();
    state_ = State::kStreaming;
    waiting_since_s_ = now_s;
    sendMore(now_s);
  } else if (!heard_ && now_s - start_s_ >= options_.connect_timeout_s) {
    fail("the firmware has not said a word in " + std::to_string(options_.connect_timeout_s) + " s");
  } else if (!heard_ && !probed_ && now_s - start_s_ >= kProbeShare * options_.connect_timeout_s) {
    probed_ = true;
    put("\n");
  }
}

/// Whether a line goes out before the ones under way are answered.
bool LineOkSender::fits(const Line& line) const {
  if (sent_ == answered_) return true;
  if (line.is_setup || lines_[answered_].is_setup) return false;
  return in_flight_bytes_ + line.text.size() + 1 <= options_.ahead_bytes;
}

void LineOkSender::sendMore(double now_s) {
  for (; sent_ < lines_.size() && fits(lines_[sent_]); ++sent_) {
    put(lines_[sent_].text);
    put("\n");
    in_flight_bytes_ += lines_[sent_].text.size() + 1;
  }
  if (answered_ < lines_.size()) return;
  state_ = options_.wait_for_idle ? State::kDraining : State::kDone;
  drain_s_ = asked_s_ = now_s;
  if (state_ == State::kDraining) put("?");
}

void LineOkSender::fail(std::string message) {
  state_ = State::kFailed;
  failure_ = std::move(message);
  outgoing_.clear();
}

std::string LineOkSender::atLine() const {
  if (state_ != State::kStreaming || answered_ >= lines_.size()) return "";
  const auto& line = lines_[answered_];
  return (line.is_setup ? " to line " + std::to_string(line.number) + " of the setup: "
                        : " to line " + std::to_string(line.number) + ": ") +
         shown(line.text);
}

double LineOkSender::progress() const {
  return lines_.empty() ? 1.0 : static_cast<double>(answered_) / static_cast<double>(lines_.size());
}

std::string LineOkSender::message() const {
  const auto of_lines = std::to_string(answered_) + " of " + std::to_string(lines_.size()) + " lines";
  switch (state_) {
    case State::kConnecting:
      return "waiting until the firmware has started";
    case State::kStreaming:
      return of_lines + " answered";
    case State::kDraining:
      return of_lines + " answered, waiting for the motion to end";
    case State::kDone:
      return of_lines + " done";
    case State::kFailed:
      break;
  }
  return failure_;
}

}  // namespace kerfbench::source
