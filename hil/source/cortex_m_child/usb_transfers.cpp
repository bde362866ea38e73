// SPDX-License-Identifier: Apache-2.0
// Transfers of the host: what transactions add up to.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "hil/source/cortex_m_child/usb_host.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint64_t kFrame = 12'000, kMs = kFrame;
constexpr std::uint64_t kPatience = 500 * kMs;       // The longest that USB 2.0, 9.2.6.4, gives a device.
constexpr std::uint64_t kAddressRecovery = 2 * kMs;  // USB 2.0, 9.2.6.3
constexpr std::uint8_t kSetAddress = 5;
constexpr unsigned kMostHalts = 3;
// Linux's cdc-acm reads twice the longest packet at a time, so that bytes behind a packet of full length wait
// for a shorter one.
constexpr std::size_t kPacketsPerRead = 2;

}  // namespace

/// Whether a device has left the host without an answer for too long.
void UsbHost::checkPatience(Bit bit) {
  const auto isMute = [&](Pipe pipe) {
    return pipes_[pipe].mute_since != kNever && bit >= pipes_[pipe].mute_since + kPatience;
  };
  if (control_ && bit >= control_->deadline)
    return refuse(
        "the firmware's USB device " +
        std::string(pipes_[kControl].mute_since != kNever ? "does not answer " : "puts off (NAK) ") +
        control_->request.name + " for 500 ms");
  for (const Pipe pipe : {kNotifications, kOut, kIn}) {
    if (isMute(pipe))
      return refuse("endpoint " + std::to_string(pipes_[pipe].endpoint) +
                    " of the firmware's USB device does not answer for 500 ms");
  }
}

void UsbHost::take(const Transaction& done) {
  PipeState& pipe = pipes_[done.pipe];
  if (done.pipe == kControl) return takeControl(done);
  if (done.answer == UsbAnswer::kStall) return halt(done.pipe, done.end);
  halts_ = 0;
  if (done.pipe == kOut) {
    pipe.is_data1 = !pipe.is_data1;
    to_send_.erase(to_send_.begin(),
                   to_send_.begin() + static_cast<std::ptrdiff_t>(done.packet.bytes.size()));
    return;
  }
  pipe.not_before = frame_start_ + (done.pipe == kNotifications ? pipe.interval_frames * kFrame : 0);
  if (done.packet.bytes.size() > pipe.most_bytes)
    return refuse("endpoint " + std::to_string(pipe.endpoint) + " of the firmware's USB device sends " +
                  std::to_string(done.packet.bytes.size()) + " bytes in a packet, and its descriptor says " +
                  std::to_string(pipe.most_bytes));
  // A packet with the other number has been sent before.
  if (done.packet.is_data1 != pipe.is_data1) return;
  pipe.is_data1 = !pipe.is_data1;
  if (done.pipe == kIn) takeBytes(done);
}

void UsbHost::takeBytes(const Transaction& done) {
  const std::size_t most = pipes_[kIn].most_bytes;
  read_.insert(read_.end(), done.packet.bytes.begin(), done.packet.bytes.end());
  if (done.packet.bytes.size() == most && read_.size() < kPacketsPerRead * most) return;
  if (on_bytes) on_bytes(read_, tickOf(done.end));
  read_.clear();
}

/// An endpoint has answered with a STALL: as Linux's cdc-acm does, the halt is cleared and the line goes on.
void UsbHost::halt(Pipe pipe, Bit bit) {
  const bool is_in = pipes_[pipe].token == UsbToken::kIn;
  if (++halts_ > kMostHalts)
    return refuse("endpoint " + std::to_string(pipes_[pipe].endpoint) + (is_in ? " (IN)" : " (OUT)") +
                  " of the firmware's USB device answers with a STALL again and again");
  if (control_) return;
  startControl(clearHalt(pipes_[pipe].endpoint | (is_in ? 0x80U : 0U)), bit);
  control_->halted = pipe;
  pipes_[pipe].not_before = kNever;
}

void UsbHost::startControl(UsbRequest request, Bit bit) {
  const Bit start = pipes_[kControl].not_before == kNever ? bit : pipes_[kControl].not_before;
  control_ = ControlTransfer{std::move(request), Stage::kSetup, 0, {}, std::max(bit, start) + kPatience, {}};
  pipes_[kControl].token = UsbToken::kSetup;
  pipes_[kControl].most_bytes = enumeration_.controlBytes();
  pipes_[kControl].is_data1 = false;
  pipes_[kControl].not_before = start;
}

/// A stage of a control transfer has gone on (USB 2.0, 8.5.3).
void UsbHost::takeControl(const Transaction& done) {
  PipeState& pipe = pipes_[kControl];
  const UsbRequest& request = control_->request;
  const std::size_t bytes = done.packet.bytes.size();
  if (done.answer == UsbAnswer::kStall) return finishControl(done.end, true);
  control_->deadline = done.end + kPatience;
  if (control_->stage == Stage::kStatus) return finishControl(done.end, false);
  bool has_all = false;
  if (control_->stage == Stage::kSetup) {
    control_->stage = Stage::kData;
    pipe.token = request.isToHost() ? UsbToken::kIn : UsbToken::kOut;
    pipe.is_data1 = true;
    has_all = request.length == 0;
  } else if (request.isToHost()) {
    if (done.packet.is_data1 != pipe.is_data1) return;
    control_->answer.insert(control_->answer.end(), done.packet.bytes.begin(), done.packet.bytes.end());
    if (bytes > pipe.most_bytes || control_->answer.size() > request.length)
      return refuse("the firmware's USB device answers " + request.name +
                    " with more bytes than were asked for");
    pipe.is_data1 = !pipe.is_data1;
    has_all = bytes < pipe.most_bytes || control_->answer.size() == request.length;
  } else {
    control_->sent += bytes;
    pipe.is_data1 = !pipe.is_data1;
    has_all = control_->sent == request.length;
  }
  if (!has_all) return;
  // The status goes the other way than the data, and to the host where there are none.
  const bool is_out = request.isToHost() && request.length > 0;
  control_->stage = Stage::kStatus;
  pipe.token = is_out ? UsbToken::kOut : UsbToken::kIn;
  pipe.is_data1 = true;
}

void UsbHost::finishControl(Bit bit, bool is_stalled) {
  const ControlTransfer done = *std::exchange(control_, std::nullopt);
  pipes_[kControl].not_before = bit + (done.request.request == kSetAddress ? kAddressRecovery : 0);
  if (done.halted) {
    if (is_stalled) return refuse("the firmware's USB device answers " + done.request.name + " with a STALL");
    pipes_[*done.halted].is_data1 = false;
    pipes_[*done.halted].not_before = bit;
    return;
  }
  if (is_stalled)
    enumeration_.stall();
  else
    enumeration_.finish(done.answer);
  if (enumeration_.isUnderWay()) return startControl(enumeration_.request(), bit);
  if (!enumeration_.refusal().empty()) return refuse(enumeration_.refusal(), enumeration_.isOtherDevice());
  open(bit);
}

void UsbHost::open(Bit bit) {
  const CdcLine& line = enumeration_.line();
  const auto pipeOf = [bit](UsbToken token, const UsbEndpoint& endpoint) {
    return PipeState{token, endpoint.number, endpoint.most_bytes, endpoint.interval_frames, false,
                     bit,   kNever};
  };
  phase_ = Phase::kOpen;
  halts_ = 0;
  pipes_[kOut] = pipeOf(UsbToken::kOut, line.to_device);
  pipes_[kIn] = pipeOf(UsbToken::kIn, line.to_host);
  if (line.notifications) pipes_[kNotifications] = pipeOf(UsbToken::kIn, *line.notifications);
}

void UsbHost::refuse(std::string words, bool is_silent) {
  phase_ = Phase::kRefused;
  refusal_ = std::move(words);
  is_silent_ = is_silent;
  control_.reset();
  pipes_ = {};
}

}  // namespace kerfbench::cortex_m_child
