// SPDX-License-Identifier: Apache-2.0
// When the host does what, and its transactions; transfers are in usb_transfers.cpp.
#include "hil/source/cortex_m_child/usb_host.h"

#include <algorithm>
#include <utility>

namespace kerfbench::cortex_m_child {
namespace {

__extension__ using Wide = unsigned __int128;

constexpr std::uint64_t kBitsPerSecond = 12'000'000, kFrame = 12'000, kMicroFrame = kFrame / 8;
constexpr std::uint64_t kMs = kFrame;
// USB 2.0, 7.1.7: a connection is stable after 100 ms; a hub's reset takes 10 ms, and the device has as much.
constexpr std::uint64_t kDebounce = 100 * kMs, kReset = 10 * kMs, kRecovery = 10 * kMs;
constexpr std::uint64_t kReturn = 1000 * kMs;  // A device that restarts is back by then.
// Packets in bits: synchronisation, identifier, CRC and end; the longest turn-around and the wait for one
// that does not come (USB 2.0, 8.3, 8.4, 7.1.18, 7.1.19).
constexpr std::uint64_t kToken = 35, kEmptyData = 35, kHandshake = 19, kTurn = 7, kNoAnswer = 18;
constexpr std::uint64_t kFrameMargin = 64;  // Nothing may still be under way at a frame's end.

/// Bits of a transaction with a packet of data.
std::uint64_t bitsOf(const UsbTarget& target, UsbAnswer answer, std::size_t bytes) {
  const std::uint64_t data = kEmptyData + 8 * bytes;
  const bool is_in = target.token == UsbToken::kIn;
  if (answer == UsbAnswer::kReady) return kToken + kTurn + data + kTurn + kHandshake;
  const std::uint64_t asked = kToken + kTurn + (is_in ? 0 : data + kTurn);
  return asked + (answer == UsbAnswer::kStall ? kHandshake : kNoAnswer);
}

}  // namespace

UsbHost::UsbHost(Present& present, const CoreTime& time, UsbDevice& device, std::deque<std::uint8_t>& to_send,
                 std::uint32_t baud)
    : present_(present), time_(time), device_(device), to_send_(to_send), baud_(baud), enumeration_(baud) {}

UsbHost::State UsbHost::state() const {
  switch (phase_) {
    case Phase::kAbsent:
      return phase_end_ == kNever ? State::kAbsent : State::kOpening;
    case Phase::kOpen:
      return State::kOpen;
    case Phase::kRefused:
      return State::kRefused;
    default:
      return State::kOpening;
  }
}

std::uint64_t UsbHost::tickOf(Bit bit) const {
  if (bit == kNever) return kNever;
  const Wide ticks = static_cast<Wide>(bit) * time_.clockHz();
  return static_cast<std::uint64_t>((ticks + kBitsPerSecond - 1) / kBitsPerSecond);
}

UsbHost::Bit UsbHost::now() const {
  const Wide ticks = time_.tickOf(present_.cycle);
  return static_cast<Bit>(ticks * kBitsPerSecond / time_.clockHz());
}

UsbHost::Bit UsbHost::nextBit() {
  if (device_.isAttached() != is_attached_) return 0;
  Bit next = phase_end_;
  if (hasFrames()) next = std::min({next, next_frame_, transaction_ ? transaction_->end : nextLook()});
  return next;
}

std::uint64_t UsbHost::nextTick() { return tickOf(nextBit()); }

/// The next eighth of a frame at which an endpoint is ready. At a frame's start all are asked in any case.
UsbHost::Bit UsbHost::nextLook() {
  for (std::size_t i = 0; i < kPipes; ++i) {
    const auto pipe = static_cast<Pipe>(i);
    if (!hasWork(pipe) || device_.poll(targetOf(pipe)) == UsbAnswer::kNak) continue;
    const Bit from = std::max(now(), pipes_[pipe].not_before);
    const Bit look = (from / kMicroFrame + 1) * kMicroFrame;
    if (look % kFrame != 0) look_ = std::min(look_, look);
  }
  return look_;
}

void UsbHost::run() {
  if (device_.isAttached() != is_attached_) return is_attached_ ? detach(now() + 1) : attach(now() + 1);
  const Bit bit = nextBit();
  if (bit == phase_end_) return enterNextPhase(bit);
  if (transaction_ && bit == transaction_->end) return end();
  if (bit == next_frame_) return startFrame(bit);
  begin(bit);
}

void UsbHost::attach(Bit bit) {
  is_attached_ = true;
  phase_ = Phase::kDebounce;
  phase_end_ = bit + kDebounce;
  refusal_.clear();
  is_silent_ = false;
}

/// Whatever was under way is lost, as when a cable is pulled.
void UsbHost::detach(Bit bit) {
  is_attached_ = false;
  const bool was_open = phase_ == Phase::kOpen;
  phase_ = Phase::kAbsent;
  phase_end_ = was_open ? bit + kReturn : kNever;
  next_frame_ = look_ = kNever;
  pipes_ = {};
  control_.reset();
  transaction_.reset();
  read_.clear();
  if (was_open) to_send_.clear();
}

void UsbHost::enterNextPhase(Bit bit) {
  phase_end_ = kNever;
  switch (phase_) {
    case Phase::kDebounce:
      device_.beginBusReset();
      phase_ = Phase::kReset;
      phase_end_ = bit + kReset;
      break;
    case Phase::kReset:
      device_.endBusReset();
      phase_ = Phase::kRecovery;
      phase_end_ = bit + kRecovery;
      next_frame_ = (bit / kFrame + 1) * kFrame + kToken;
      break;
    case Phase::kRecovery:
      phase_ = Phase::kEnumerating;
      enumeration_ = UsbEnumeration(baud_);
      startControl(enumeration_.request(), bit);
      break;
    default:  // Absent, and open before.
      refuse("the firmware has taken its USB device off the bus, and it has not come back", true);
  }
}

/// The packet that starts a frame has ended.
void UsbHost::startFrame(Bit bit) {
  frame_start_ = bit - kToken;
  next_frame_ = bit + kFrame;
  device_.startFrame(frame_start_ / kFrame);
  checkPatience(bit);
  begin(bit);
}

UsbTarget UsbHost::targetOf(Pipe pipe) const {
  return {pipes_[pipe].token, enumeration_.address(), pipes_[pipe].endpoint};
}

bool UsbHost::hasWork(Pipe pipe) const {
  if (pipes_[pipe].not_before == kNever) return false;
  return pipe == kControl ? control_.has_value() : pipe != kOut || !to_send_.empty();
}

/// Packet for the device: its next bytes.
UsbPacket UsbHost::packetFor(Pipe pipe) const {
  UsbPacket packet{pipes_[pipe].is_data1, {}};
  const auto most = static_cast<std::ptrdiff_t>(pipes_[pipe].most_bytes);
  if (pipe == kOut) {
    packet.bytes.assign(to_send_.begin(),
                        to_send_.begin() + std::min(most, static_cast<std::ptrdiff_t>(to_send_.size())));
  } else if (pipe == kControl && control_->stage == Stage::kSetup) {
    packet.bytes = control_->request.setupBytes();
  } else if (pipe == kControl && control_->stage == Stage::kData) {
    const auto& data = control_->request.data;
    const auto first = data.begin() + static_cast<std::ptrdiff_t>(control_->sent);
    packet.bytes.assign(first, first + std::min(most, data.end() - first));
  }
  return packet;
}

/// Asks the endpoints in turn for what can be done now.
void UsbHost::begin(Bit bit) {
  look_ = kNever;
  if (phase_ == Phase::kRefused) return;
  for (const Pipe pipe : {kControl, kNotifications, in_is_next_ ? kIn : kOut, in_is_next_ ? kOut : kIn}) {
    if (beginOn(pipe, bit)) return;
  }
}

bool UsbHost::beginOn(Pipe pipe, Bit bit) {
  if (!hasWork(pipe) || bit < pipes_[pipe].not_before) return false;
  Transaction next{pipe, targetOf(pipe), UsbAnswer::kNone, {}, 0};
  next.answer = device_.poll(next.target);
  if (next.answer == UsbAnswer::kNak) return false;
  const bool is_in = next.target.token == UsbToken::kIn;
  if (!is_in) next.packet = packetFor(pipe);
  const std::size_t most = is_in ? pipes_[pipe].most_bytes : next.packet.bytes.size();
  if (bit + bitsOf(next.target, next.answer, most) + kFrameMargin > frame_start_ + kFrame) return false;
  if (is_in && next.answer == UsbAnswer::kReady) next.packet = device_.fetch(next.target);
  next.end = bit + bitsOf(next.target, next.answer, next.packet.bytes.size());
  transaction_ = std::move(next);
  in_is_next_ = pipe == kOut;
  return true;
}

void UsbHost::end() {
  Transaction done = *std::exchange(transaction_, std::nullopt);
  if (done.answer == UsbAnswer::kReady) {
    if (done.target.token == UsbToken::kIn)
      device_.acknowledge(done.target);
    else
      done.answer = device_.receive(done.target, done.packet);
  }
  PipeState& pipe = pipes_[done.pipe];
  if (done.answer == UsbAnswer::kNone) {
    pipe.mute_since = std::min(pipe.mute_since, done.end);
    pipe.not_before = frame_start_ + kFrame;
  } else {
    pipe.mute_since = kNever;
    take(done);
  }
  begin(done.end);
}

}  // namespace kerfbench::cortex_m_child
