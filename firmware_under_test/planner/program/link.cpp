// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/link.h"

#include <algorithm>
#include <utility>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::planner {

namespace {

constexpr double kConnectTime_s = 2.0;
constexpr double kReplyTime_s = KB_REPLY_TIMEOUT_MS * 1e-3;
// Time between STATUS requests while the queue is full: twelve periods, some 60 bytes of a queue of 4096.
constexpr double kFullQueueTime_s = 0.010;
constexpr double kStateTime_s =
    0.050;  // Time between STATUS requests once all is sent: an EVENT could be lost.
constexpr double kAccountTime_s = 0.250;  // Time for the answer to the last question.
constexpr int kMaxRepeats = 20;
constexpr std::size_t kOverhead = 6;  // Overhead of a frame: SYNC TYPE SEQ LEN CRC CRC.

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<unsigned>(byte) << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1) ^ 0x1021U : crc << 1;
    }
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

std::string_view refusalInWords(std::uint8_t reason) {
  switch (reason) {
    case KB_NAK_CRC:
      return "its checksum is wrong";
    case KB_NAK_TYPE:
      return "it does not know this request";
    case KB_NAK_LENGTH:
      return "its length is wrong";
    case KB_NAK_FULL:
      return "the queue is full";
    case KB_NAK_STATE:
      return "it is not allowed in this state";
    case KB_NAK_VALUE:
      return "a value is out of range";
    case KB_NAK_CHECK:
      return "it is not the program that was sent (job check)";
    default:
      return "of a reason that this host does not know";
  }
}

std::string_view requestInWords(std::uint8_t type) {
  switch (type) {
    case KB_HELLO:
      return "the greeting";
    case KB_CONFIG:
      return "the configuration";
    case KB_POWER:
      return "the laser's curve for the loop on its power";
    case KB_DATA:
      return "a part of the program";
    case KB_START:
      return "the start";
    case KB_STATUS:
      return "the question for its state";
    default:
      return "a request";
  }
}

}  // namespace

std::string_view faultInWords(std::uint8_t fault) {
  switch (fault) {
    case KB_OK:
      return "it was told to stop";
    case KB_FAULT_DRY:
      return "its queue ran dry in the middle of the program";
    case KB_FAULT_INTERLOCK:
      return "the guard was opened (interlock)";
    case KB_FAULT_LIMIT:
      return "an axis reached its end-of-travel switch";
    case KB_FAULT_PROGRAM:
      return "the program holds an operation that it does not know";
    case KB_FAULT_OVERSPEED:
      return "the program asks for more steps in a period than it can make";
    case KB_FAULT_LATE:
      return "it did not prepare the next period in time";
    case KB_FAULT_MARKS:
      return "more print marks came than it can keep";
    case KB_FAULT_SILENT:
      return "it heard nothing from its host for too long";
    case KB_FAULT_UART:
      return "the line to it is disturbed";
    case KB_FAULT_ENCODER:
      return "the belt's encoder does not tell of the motion that it should (broken wire?)";
    case KB_FAULT_BELT_FAST:
      return "the belt is too fast for this job";
    case KB_FAULT_WATCHDOG:
      return "its main loop stood still, and its watchdog reset it";
    case KB_FAULT_FIELD:
      return "the belt would have taken the beam out of its field";
    default:
      return "of a fault that this host does not know";
  }
}

Link::Link(Program program) : program_(std::move(program)) {
  const bool op_too_long = std::any_of(program_.ops.begin(), program_.ops.end(), [](const auto& op) {
    return op.empty() || op.size() > KB_PAYLOAD_MAX - KB_CHECK_LEN;
  });
  if (program_.config.size() != KB_CONFIG_LEN) {
    fail("the program's configuration does not have " + std::to_string(KB_CONFIG_LEN) + " bytes");
  } else if (program_.ops.empty()) {
    fail("the program is empty");
  } else if (op_too_long) {
    fail("the program holds an operation that fits no frame");
  }
}

std::vector<std::uint8_t> Link::step(std::span<const std::uint8_t> received, double now_s) {
  now_s_ = now_s;
  if (first_s_ < 0.0) {
    first_s_ = now_s;
  }
  out_.clear();
  received_.insert(received_.end(), received.begin(), received.end());
  while (state_ != State::kFailed && state_ != State::kDone) {
    const std::optional<Reply> reply = takeReply();
    if (!reply) {
      break;
    }
    accept(*reply);
  }
  if (end_ && now_s_ - end_s_ >= kAccountTime_s) conclude();
  if (state_ == State::kFailed || state_ == State::kDone) {
    return {};
  }
  if (!frame_.empty()) {
    const bool silent = now_s_ - sent_s_ >= kReplyTime_s;
    if (state_ == State::kConnecting) {
      if (now_s_ - first_s_ >= kConnectTime_s) {
        fail("the controller does not answer");
        return {};
      }
    } else if ((silent || resend_) && ++repeats_ > kMaxRepeats) {
      fail("the controller no longer answers to " + std::string(requestInWords(frame_[1])));
      return {};
    }
    if (silent || resend_) {
      out_.insert(out_.end(), frame_.begin(), frame_.end());
      sent_s_ = now_s_;
      resend_ = false;
    }
  } else {
    sendNext();
  }
  return out_;
}

std::optional<Link::Reply> Link::takeReply() {
  for (;;) {
    const auto sync = std::find(received_.begin(), received_.end(), KB_SYNC);
    received_.erase(received_.begin(), sync);
    if (received_.size() < 4) {
      return std::nullopt;
    }
    const std::size_t length = received_[3];
    if (length <= KB_PAYLOAD_MAX) {
      if (received_.size() < length + kOverhead) {
        return std::nullopt;
      }
      const std::size_t end = 4 + length;
      const unsigned sent = received_[end] | static_cast<unsigned>(received_[end + 1]) << 8;
      if (crc16(std::span(received_).subspan(1, end - 1)) == sent) {
        Reply reply{received_[1],
                    received_[2],
                    {received_.begin() + 4, received_.begin() + static_cast<std::ptrdiff_t>(end)}};
        received_.erase(received_.begin(),
                        received_.begin() + static_cast<std::ptrdiff_t>(length + kOverhead));
        return reply;
      }
    }
    received_.erase(received_.begin());  // The bytes are not a frame: look for the next SYNC.
  }
}

void Link::accept(const Reply& reply) {
  if (reply.type == KB_INFO) {
    infoSeen(reply.payload);
  } else if (reply.type == KB_EVENT && reply.payload.size() == 2) {
    stateSeen(reply.payload[0], reply.payload[1]);
  } else if (reply.type == KB_STATE && reply.payload.size() >= 4) {
    stateSeen(reply.payload[0], reply.payload[1]);
    if (end_ && reply.payload[0] != KB_RUNNING) conclude();
  } else if (reply.type == KB_INFO && !reply.payload.empty() && reply.payload[0] != KB_PROTOCOL_VERSION) {
    fail("the controller speaks version " + std::to_string(reply.payload[0]) +
         " of the protocol, this host " + std::to_string(KB_PROTOCOL_VERSION));
  } else if (!frame_.empty() && reply.seq == seq_) {
    if (reply.type == KB_ACK && reply.payload.size() == 2) {
      accepted(reply.payload[0] | static_cast<std::size_t>(reply.payload[1]) << 8);
    } else if (reply.type == KB_NAK && reply.payload.size() == 1) {
      refused(reply.payload[0]);
    }
  }
}

void Link::accepted(std::size_t free_bytes) {
  free_bytes_ = free_bytes;
  const std::uint8_t type = frame_[1];
  frame_.clear();
  repeats_ = 0;
  resend_ = false;
  if (type == KB_HELLO) {
    state_ = State::kConfiguring;
  } else if (type == KB_CONFIG && !program_.power.empty()) {
    send(KB_POWER, program_.power);
  } else if (type == KB_CONFIG || type == KB_POWER) {
    state_ = State::kLoading;
    check_ = {};
    for (const std::uint8_t byte : program_.config) check_.add(byte);
    for (const std::uint8_t byte : program_.power) check_.add(byte);
  } else if (type == KB_DATA) {
    op_ += ops_under_way_;
    check_ = check_under_way_;
  } else if (type == KB_START) {
    state_ = State::kRunning;
    asked_s_ = now_s_;
  }
}

void Link::refused(std::uint8_t reason) {
  if (end_) {
    frame_.clear();  // A late frame is dropped, whatever it was.
    return;
  }
  // The first three can come from noise on the line; the last heals as the queue empties.
  if (reason == KB_NAK_CRC || reason == KB_NAK_CHECK) {
    resend_ = true;
  } else if (reason == KB_NAK_STATE && state_ == State::kRunning) {
    frame_.clear();
    refused_in_run_ = true;
  } else if (reason != KB_NAK_LENGTH && reason != KB_NAK_FULL) {
    fail("the controller refuses " + std::string(requestInWords(frame_[1])) + ": " +
         std::string(refusalInWords(reason)));
  }
}

/// Follows the answer to HELLO, with its sequence number; if it is lost, HELLO is sent again.
void Link::infoSeen(std::span<const std::uint8_t> payload) {
  constexpr std::size_t kBeforeBlock = 6;
  if (found_ || state_ != State::kConfiguring) return;
  found_ = payload.size() > kBeforeBlock ? targetFrom(payload.subspan(kBeforeBlock)) : std::nullopt;
  if (!found_) {
    fail("the controller does not say what it is: its firmware is another version than this host");
  } else if (const std::string other = differenceOf(program_.target, *found_); !other.empty()) {
    fail("the program was planned for another controller: this one has " + other);
  }
}

void Link::stateSeen(std::uint8_t state, std::uint8_t fault) {
  if (state_ != State::kRunning && !(state_ == State::kLoading && !frame_.empty() && frame_[1] == KB_START)) {
    return;  // The frame belongs to an earlier program.
  }
  if (state == KB_STOPPED) {
    ended("the controller stopped: " + std::string(faultInWords(fault)));
  } else if (state == KB_DONE) {
    const bool whole = op_ + (frame_.empty() ? 0 : ops_under_way_) >= program_.ops.size();
    ended(whole ? "" : "the controller says that it is done before it has the whole program");
  } else if (refused_in_run_ || (state == KB_IDLE && state_ == State::kRunning)) {
    fail("the controller has lost the program: it may have been reset");
  }
}

void Link::ended(std::string why) {
  if (end_) return;  // The first reason counts.
  end_ = std::move(why);
  end_s_ = now_s_;
}

void Link::conclude() {
  if (end_->empty()) {
    state_ = State::kDone;
  } else {
    fail(*end_);
  }
}

void Link::fail(std::string why) {
  state_ = State::kFailed;
  failure_ = std::move(why);
}

void Link::sendNext() {
  const bool wholly_sent = op_ == program_.ops.size() || end_;
  const bool fits = !wholly_sent && free_bytes_ >= program_.ops[op_].size();
  const bool frame_fits = !wholly_sent && free_bytes_ >= KB_PAYLOAD_MAX;
  switch (state_) {
    case State::kConnecting:
      send(KB_HELLO, {});
      break;
    case State::kConfiguring:
      if (found_) {
        send(KB_CONFIG, program_.config);
      } else if (now_s_ - sent_s_ >= kReplyTime_s) {
        state_ = State::kConnecting;
        send(KB_HELLO, {});
      }
      break;
    case State::kLoading:
      if (end_) {
        send(KB_STATUS, {});
      } else if (fits && frame_fits) {
        sendData();
      } else {
        std::vector<std::uint8_t> payload;
        check_.appendTo(payload);
        send(KB_START, payload);
      }
      break;
    default:
      if (refused_in_run_ || end_) {
        send(KB_STATUS, {});
      } else if (fits && frame_fits) {
        sendData();
      } else if (now_s_ - asked_s_ >= (wholly_sent ? kStateTime_s : kFullQueueTime_s)) {
        send(KB_STATUS, {});
        asked_s_ = now_s_;
      }
  }
}

void Link::sendData() {
  std::vector<std::uint8_t> payload;
  const std::size_t room = std::min<std::size_t>(KB_PAYLOAD_MAX - KB_CHECK_LEN, free_bytes_);
  std::size_t end = op_;
  while (end < program_.ops.size() && payload.size() + program_.ops[end].size() <= room) {
    payload.insert(payload.end(), program_.ops[end].begin(), program_.ops[end].end());
    ++end;
  }
  ops_under_way_ = end - op_;
  check_under_way_ = check_;
  for (const std::uint8_t byte : payload) check_under_way_.add(byte);
  check_under_way_.appendTo(payload);
  send(KB_DATA, payload);
}

void Link::Check::appendTo(std::vector<std::uint8_t>& payload) const {
  for (const unsigned half : {unsigned{a}, unsigned{b}}) {
    payload.push_back(static_cast<std::uint8_t>(half & 0xFFU));
    payload.push_back(static_cast<std::uint8_t>(half >> 8));
  }
}

void Link::send(std::uint8_t type, std::span<const std::uint8_t> payload) {
  ++seq_;
  frame_ = {KB_SYNC, type, seq_, static_cast<std::uint8_t>(payload.size())};
  frame_.insert(frame_.end(), payload.begin(), payload.end());
  const std::uint16_t crc = crc16(std::span(frame_).subspan(1));
  frame_.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  frame_.push_back(static_cast<std::uint8_t>(crc >> 8));
  out_.insert(out_.end(), frame_.begin(), frame_.end());
  sent_s_ = now_s_;
  if (type != KB_DATA) {
    ops_under_way_ = 0;
  }
}

Link::State Link::state() const { return state_; }

double Link::progress() const {
  return program_.ops.empty() ? 0.0 : static_cast<double>(op_) / static_cast<double>(program_.ops.size());
}

std::string Link::message() const {
  const int percent = static_cast<int>(progress() * 100.0);
  switch (state_) {
    case State::kConnecting:
      return "waiting for the controller's first answer";
    case State::kConfiguring:
      return "configuring the controller";
    case State::kLoading:
      return "filling the controller's queue, " + std::to_string(percent) + " % of the program sent";
    case State::kRunning:
      return "running, " + std::to_string(percent) + " % of the program sent";
    case State::kDone:
      return "the controller has done the whole program";
    case State::kFailed:
      break;
  }
  return failure_;
}

}  // namespace kerfbench::planner
