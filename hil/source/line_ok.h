// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerfbench::source {

/// Options of LineOkSender; times are virtual seconds.
struct LineOkOptions {
  double connect_timeout_s{3.0};  ///< Time to wait for a first line, or an answer to an empty line.
  /// Time to wait for the answer to one line: a full queue holds it back for a whole move.
  double reply_timeout_s{60.0};
  double drain_timeout_s{600.0};  ///< Time to wait for the rest of the motion after the last ok.
  bool wait_for_idle{
      true};  ///< Ask for the state ('?') until <Idle…>; firmware that does not answer is done at once.
};

/// Sends a program to firmware that speaks "a line, then wait for ok", as Grbl and its many relatives do.
///
/// A pure state machine, like planner::Link: bytes and time in, bytes out. One line is under way at a time,
/// so an error names the line that caused it. Comments and blank lines are left out; line numbers stay those
/// of the program.
class LineOkSender {
 public:
  enum class State { kConnecting, kStreaming, kDraining, kDone, kFailed };
  explicit LineOkSender(std::string_view program, const LineOkOptions& options = {});

  /// Bytes from the controller and the time now; returns bytes for it.
  std::vector<std::uint8_t> step(std::span<const std::uint8_t> received, double now_s);

  [[nodiscard]] State state() const { return state_; }
  /// One sentence for people: why it failed, or how far it is.
  [[nodiscard]] std::string message() const;
  /// Share of the lines that have been answered, 0 … 1.
  [[nodiscard]] double progress() const;

 private:
  struct Line {
    std::size_t number{};  ///< Number in the program, from 1.
    std::string text;
  };
  void takeLine(std::string_view line, double now_s);
  void takeReport(std::string_view report);
  void watchTime(double now_s);
  void beginStreaming(double now_s);
  void sendNext(double now_s);
  void put(std::string_view text) { outgoing_.insert(outgoing_.end(), text.begin(), text.end()); }
  void fail(std::string message);
  [[nodiscard]] std::string atLine() const;

  LineOkOptions options_;
  std::vector<Line> lines_;
  std::size_t answered_{};
  State state_{State::kConnecting};
  std::vector<std::uint8_t> outgoing_;
  std::string partial_;
  std::string failure_;
  bool started_{};
  bool probed_{};
  bool banner_seen_{};
  double start_s_{};
  double settle_s_{};
  double sent_s_{};
  double drain_s_{};
  double asked_s_{};
  bool report_seen_{};
};

}  // namespace kerfbench::source
