// SPDX-License-Identifier: Apache-2.0
#include "tests/board/board.h"

#include <algorithm>

namespace kerfbench::board {
namespace {

constexpr std::uint64_t kSecond_ns = 1'000'000'000;
__extension__ using Wide = unsigned __int128;

}  // namespace

Board::Board(source::SignalSource& release, const SignalMap& pins, const std::vector<Signal>& wired,
             BoardPorts& ports, const BoardOptions& options)
    : release_(release), rate_(release.info().rate), pins_(pins), ports_(ports), options_(options) {
  for (const Signal signal : wired) {
    if (isSensor(signal)) {
      inputs_[signal] = false;
    } else {
      outputs_[pins_.pin(signal).value()] = signal;
    }
  }
}

BoardPace Board::run() {
  begin_ns_ = looked_ns_ = ports_.now_ns();
  std::uint64_t next_step_ns = begin_ns_ + options_.step_ns;
  while (!pace_.halted) {
    putDue();
    const std::uint64_t now_ns = ports_.now_ns();
    if (now_ns >= begin_ns_ + options_.run_ns) break;
    if (now_ns >= next_step_ns) {
      step(now_ns);
      next_step_ns = std::max(next_step_ns, now_ns) + options_.step_ns;
      continue;
    }
    ports_.sleepUntil(strokes_.empty() ? next_step_ns : std::min(next_step_ns, strokes_.front().at_ns));
  }
  return pace_;
}

void Board::step(std::uint64_t now_ns) {
  pace_.worst_step_ns = std::max(pace_.worst_step_ns, now_ns - looked_ns_);
  looked_ns_ = now_ns;
  const Tick now = static_cast<Tick>(Wide{now_ns - begin_ns_} * rate_.den / (Wide{rate_.num} * kSecond_ns));
  if (now <= batch_.watermark) return;
  lookAtInputs(now);
  if (const std::vector<std::uint8_t> bytes = ports_.receive(); !bytes.empty()) release_.uartWrite(bytes);
  pace_.halted = release_.advance(now, batch_) != source::Stop::kReached;
  for (const PinEvent& event : batch_.events) take(event);
  ports_.send(batch_.uart);
}

/// Reads the inputs. An edge is seen at the end of its step: there the release gets it.
void Board::lookAtInputs(Tick now) {
  for (auto& [signal, before] : inputs_) {
    const bool level = ports_.level(signal);
    if (level == before) continue;
    before = level;
    release_.drive(pins_.pin(signal).value(), level, now);
  }
}

void Board::take(const PinEvent& event) {
  const std::uint64_t at_ns =
      begin_ns_ + static_cast<std::uint64_t>(Wide{event.tick} * rate_.num * kSecond_ns / rate_.den) +
      options_.delay_ns;
  for (std::uint16_t bit = 0; bit < 16; ++bit) {
    if ((event.changed >> bit & 1U) == 0) continue;
    const auto output = outputs_.find({event.port, bit});
    if (output != outputs_.end()) strokes_.push_back({at_ns, output->second, (event.level >> bit & 1U) != 0});
  }
}

void Board::putDue() {
  for (; !strokes_.empty(); strokes_.pop_front()) {
    const Stroke& stroke = strokes_.front();
    const std::uint64_t now_ns = ports_.now_ns();
    if (stroke.at_ns > now_ns) return;
    ports_.put(stroke.signal, stroke.level);
    ++pace_.strokes;
    pace_.worst_late_ns = std::max(pace_.worst_late_ns, now_ns - stroke.at_ns);
  }
}

}  // namespace kerfbench::board
