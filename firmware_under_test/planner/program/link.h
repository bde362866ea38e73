// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_under_test/planner/program/plan.h"

namespace kerfbench::planner {

/// Reason of a controller's stop, for people: "its queue ran dry in the middle of the program". @param fault
/// enum kb_fault.
std::string_view faultInWords(std::uint8_t fault);

/// Host half of protocol.h as a pure state machine: bytes and time in, bytes out. Sends HELLO until answered,
/// then CONFIG, fills the queue, START, keeps the queue full, waits for DONE. When the controller has done or
/// stopped it is asked once more for the positions of axes and belt (KB_STATE), for other readers of the
/// line.
class Link {
 public:
  enum class State { kConnecting, kConfiguring, kLoading, kRunning, kDone, kFailed };
  explicit Link(Program program);

  /// Takes bytes from the controller and the present time (virtual seconds); returns bytes for it.
  std::vector<std::uint8_t> step(std::span<const std::uint8_t> received, double now_s);

  [[nodiscard]] State state() const;
  /// State for people in one sentence: why it failed, or how far it is.
  [[nodiscard]] std::string message() const;
  /// Version from the controller's INFO; empty before.
  [[nodiscard]] std::string version() const { return found_ ? found_->version : std::string(); }
  /// Share of the program sent, 0 … 1.
  [[nodiscard]] double progress() const;

 private:
  /// A frame of the controller, its CRC proven.
  struct Reply {
    std::uint8_t type{};
    std::uint8_t seq{};
    std::vector<std::uint8_t> payload;
  };

  std::optional<Reply> takeReply();
  void accept(const Reply& reply);
  void accepted(std::size_t free_bytes);
  void refused(std::uint8_t reason);
  void infoSeen(std::span<const std::uint8_t> payload);
  void stateSeen(std::uint8_t state, std::uint8_t fault);
  /// Records the end of the controller's run; an empty `why` is a success.
  void ended(std::string why);
  /// Takes over the end that ended() recorded.
  void conclude();
  void fail(std::string why);
  /// Sends the next frame, or nothing now.
  void sendNext();
  void send(std::uint8_t type, std::span<const std::uint8_t> payload);
  void sendData();

  Program program_;
  State state_{State::kConnecting};
  std::string failure_;
  std::vector<std::uint8_t> received_;  ///< Received bytes that are not yet a whole frame.
  std::vector<std::uint8_t> out_;       ///< Bytes that step() returns.
  double now_s_{};
  double first_s_{-1.0};         ///< Time of the first step().
  std::optional<Target> found_;  ///< Controller as its INFO describes it.
  std::size_t op_{};             ///< First operation not yet accepted.
  std::size_t ops_under_way_{};  ///< Operations in the frame that waits for its answer.
  std::size_t free_bytes_{};
  std::vector<std::uint8_t> frame_;  ///< Frame that waits for its answer; empty: none.
  std::uint8_t seq_{};
  double sent_s_{};
  double asked_s_{};  ///< Time of the last STATUS.
  /// Job check (protocol.h) of all that the controller has accepted, and with the frame that waits.
  struct Check {
    std::uint16_t a{1}, b{};
    void add(std::uint8_t byte) {
      a = static_cast<std::uint16_t>(a + byte);
      b = static_cast<std::uint16_t>(b + a);
    }
    void appendTo(std::vector<std::uint8_t>& payload) const;
  };
  Check check_, check_under_way_;
  std::optional<std::string> end_;  ///< Reason that ended() recorded.
  double end_s_{};
  int repeats_{};
  /// True if a frame was refused while running: the state is requested before giving up.
  bool refused_in_run_{false};
  bool resend_{false};
};

}  // namespace kerfbench::planner
