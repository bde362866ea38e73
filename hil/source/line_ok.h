// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerfbench::source {

/// Options of LineOkSender; times are virtual seconds.
struct LineOkOptions {
  std::vector<std::string> setup{};  ///< Lines sent before the program, each answered before the next.
  /// Bytes of the firmware's receive buffer that lines may fill before they are answered ("character
  /// counting"); 0: a line is sent when the one before is answered.
  std::size_t ahead_bytes{0};
  double connect_timeout_s{3.0};  ///< Time to wait for a first word, or an answer to an empty line.
  /// The first line is sent when nothing has been heard for so long: firmware that is still starting loses
  /// what comes.
  double quiet_s{0.3};
  /// Time to wait for the answer to one line: a full queue holds it back for a whole move.
  double reply_timeout_s{60.0};
  double drain_timeout_s{600.0};  ///< Time to wait for the rest of the motion after the last ok.
  bool wait_for_idle{true};       ///< Ask for the state ('?') until <Idle…>.
};

/// Sends a program to firmware that answers each line by `ok`, as Grbl and its many relatives do.
///
/// A pure state machine, like planner::Link: bytes and time in, bytes out. What the firmware says while it
/// starts is kept, and not held against it: one with blank settings complains of them. From the first line on
/// `error` and `ALARM` end the job, with the line that caused them, as does the firmware's own greeting,
/// which says that it has started again. Comments and blank lines are left out; line numbers stay those of
/// the program.
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
  /// Done, and the firmware has not said that it is at rest: whoever sees its pins knows.
  [[nodiscard]] bool mayStillMove() const { return state_ == State::kDone && !idle_seen_; }
  /// What the firmware complained of before it was asked anything: lines that begin with error or ALARM.
  [[nodiscard]] const std::vector<std::string>& complaintsAtStart() const { return complaints_; }

 private:
  struct Line {
    std::size_t number{};  ///< Number in the program, or in the lines before it, from 1.
    std::string text;
    bool is_setup{};
  };
  void takeLine(std::string_view line, double now_s);
  void takeBootLine(std::string_view line);
  void takeAnswer(std::string_view line, double now_s);
  void takeReport(std::string_view report);
  void watchTime(double now_s);
  void watchStart(double now_s);
  void sendMore(double now_s);
  [[nodiscard]] bool fits(const Line& line) const;
  void put(std::string_view text) { outgoing_.insert(outgoing_.end(), text.begin(), text.end()); }
  void fail(std::string message);
  [[nodiscard]] std::string atLine() const;

  LineOkOptions options_;
  std::vector<Line> lines_;
  std::size_t sent_{};
  std::size_t answered_{};
  std::size_t in_flight_bytes_{};
  State state_{State::kConnecting};
  std::vector<std::uint8_t> outgoing_;
  /// Lines of the start that say nothing of a state, and how often each came.
  std::map<std::string, int, std::less<>> greeting_;
  std::vector<std::string> complaints_;
  std::string partial_;
  std::string failure_;
  bool started_{};
  bool probed_{};
  bool heard_{};
  double start_s_{};
  double first_heard_s_{};
  double heard_s_{};
  double waiting_since_s_{};
  double drain_s_{};
  double asked_s_{};
  bool report_seen_{};
  bool idle_seen_{};
};

}  // namespace kerfbench::source
