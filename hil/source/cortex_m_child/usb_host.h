// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hil/source/cortex_m_child/core_time.h"
#include "hil/source/cortex_m_child/usb_device.h"
#include "hil/source/cortex_m_child/usb_enumeration.h"

namespace kerfbench::cortex_m_child {

/// The host at the other end of the USB cable (USB 2.0 2000, chapters 5, 8 and 9): it sees the device come,
/// resets the bus, asks what the device is, opens its serial line and moves the bench's bytes.
///
/// Times are bits of the bus since the start, 12 in a microsecond, so that nothing depends on the core's
/// clock or on how a run is cut into quanta. A frame begins each 12 000 bits. An endpoint that is not ready
/// (NAK) is asked again at each eighth of a frame, as by the transaction translator of a high-speed hub; what
/// such a question costs on the bus, and stuffed bits, are not counted.
class UsbHost {
 public:
  /// Absent: no device has come. Refused: one is there, and it is no serial line.
  enum class State { kAbsent, kOpening, kOpen, kRefused };

  /// @param to_send bytes for the device; those that it has acknowledged are taken out.
  UsbHost(Present& present, const CoreTime& time, UsbDevice& device, std::deque<std::uint8_t>& to_send,
          std::uint32_t baud);

  [[nodiscard]] State state() const;
  /// Why the device is no serial line, in whole words.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  /// Whether the device may be right as it is, and is missed only by who wants to talk to it.
  [[nodiscard]] bool isSilentRefusal() const { return is_silent_; }
  /// Tick at which the host does something next.
  [[nodiscard]] std::uint64_t nextTick();
  /// Does what is due at nextTick().
  void run();
  /// Called with bytes of the device, and the tick at which their transfer has ended.
  std::function<void(std::span<const std::uint8_t>, std::uint64_t tick)> on_bytes;

 private:
  using Bit = std::uint64_t;
  enum class Phase { kAbsent, kDebounce, kReset, kRecovery, kEnumerating, kOpen, kRefused };
  enum Pipe : std::size_t { kControl, kNotifications, kOut, kIn, kPipes };
  struct PipeState {
    UsbToken token{};
    unsigned endpoint{};
    unsigned most_bytes{};
    unsigned interval_frames{1};
    bool is_data1{};
    Bit not_before{kNever};  ///< The pipe is not used until then.
    Bit mute_since{kNever};  ///< No answer has come since.
  };
  struct Transaction {
    Pipe pipe{};
    UsbTarget target;
    UsbAnswer answer{};
    UsbPacket packet;
    Bit end{};
  };
  enum class Stage { kSetup, kData, kStatus };
  struct ControlTransfer {
    UsbRequest request;
    Stage stage{};
    std::size_t sent{};
    std::vector<std::uint8_t> answer;
    Bit deadline{};
    std::optional<Pipe> halted;  ///< What it clears; nothing where it is a step of the enumeration.
  };

  [[nodiscard]] std::uint64_t tickOf(Bit bit) const;
  [[nodiscard]] Bit now() const;
  [[nodiscard]] bool hasFrames() const { return phase_ >= Phase::kRecovery; }
  [[nodiscard]] Bit nextBit();
  [[nodiscard]] Bit nextLook();
  void attach(Bit bit);
  void detach(Bit bit);
  void enterNextPhase(Bit bit);
  void startFrame(Bit bit);
  void checkPatience(Bit bit);

  [[nodiscard]] UsbTarget targetOf(Pipe pipe) const;
  [[nodiscard]] bool hasWork(Pipe pipe) const;
  [[nodiscard]] UsbPacket packetFor(Pipe pipe) const;
  void begin(Bit bit);
  bool beginOn(Pipe pipe, Bit bit);
  void end();
  void take(const Transaction& done);
  void takeControl(const Transaction& done);
  void takeBytes(const Transaction& done);
  void halt(Pipe pipe, Bit bit);

  void startControl(UsbRequest request, Bit bit);
  void finishControl(Bit bit, bool is_stalled);
  void open(Bit bit);
  void refuse(std::string words, bool is_silent = false);

  Present& present_;
  const CoreTime& time_;
  UsbDevice& device_;
  std::deque<std::uint8_t>& to_send_;
  std::uint32_t baud_;
  Phase phase_{Phase::kAbsent};
  Bit phase_end_{kNever};
  bool is_attached_{};
  Bit frame_start_{};  ///< The frame that is under way, or in a reset the next one.
  Bit next_frame_{kNever};
  Bit look_{kNever};  ///< When the host asks endpoints that have become ready.
  UsbEnumeration enumeration_;
  std::array<PipeState, kPipes> pipes_;
  std::optional<ControlTransfer> control_;
  std::optional<Transaction> transaction_;
  bool in_is_next_{};
  unsigned halts_{};
  std::vector<std::uint8_t> read_;  ///< What the transfer from the device has until now.
  std::string refusal_;
  bool is_silent_{};
};

}  // namespace kerfbench::cortex_m_child
