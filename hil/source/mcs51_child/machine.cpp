// SPDX-License-Identifier: Apache-2.0
#include "hil/source/mcs51_child/machine.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "hil/source/emulator/image_file.h"
#include "hil/source/emulator/intel_hex.h"

namespace kerfbench::mcs51_child {
namespace {

constexpr std::uint64_t kMaxClock_hz = 100'000'000;

/// The code memory; bytes that the image does not set are 0xFF, as after an erase.
std::vector<std::uint8_t> readCode(const std::string& path, const Part& part) {
  std::vector<std::uint8_t> code(part.code_bytes, 0xFF);
  bool is_empty = true;
  const auto place = [&](std::uint64_t address, std::span<const std::uint8_t> bytes,
                         const std::string& where) {
    if (address > code.size() || bytes.size() > code.size() - address) {
      emulator::refuseImage(
          path, where, "data at address " + std::to_string(address) + " is outside the controller's memory");
    }
    std::ranges::copy(bytes, code.begin() + static_cast<std::ptrdiff_t>(address));
    is_empty = is_empty && bytes.empty();
  };
  emulator::readIntelHex(emulator::imageContent(path), path, place);
  if (is_empty) emulator::refuseImage(path, "", "the image holds no code");
  return code;
}

}  // namespace

Machine::Machine(const emulator::OpenRequest& asked)
    : asked_(asked), part_(partCalled(asked.mcu)), pace_(asked.clock_hz, asked.baud) {
  emulator::checkRates(asked, kMaxClock_hz);
  if (!asked.eeprom.empty()) throw std::runtime_error("the " + asked.mcu + " has no EEPROM to fill");
  chip_ = std::make_unique<Chip>(part_, readCode(asked.image_path, part_),
                                 static_cast<std::size_t>(asked.max_events));
}

emulator::Clock Machine::clock() const {
  // Where the data sheet is silent: a machine cycle of the serial port's flags, the longest instruction of
  // the STC15.
  return {1, asked_.clock_hz, part_.is_stc15 ? 6U : 12U};
}

std::string Machine::configuration() const {
  return "kerfbench-mcs51 1, " +
         std::string(part_.is_stc15 ? "STC-Y5 with a clock a machine cycle"
                                    : "MCS-51 with 12 clocks a machine cycle") +
         "; mcu " + asked_.mcu + " at " + std::to_string(asked_.clock_hz) + " Hz, " +
         std::to_string(asked_.baud) + " baud";
}

void Machine::drive(std::uint64_t tick, std::uint16_t port, std::uint16_t bit, bool level) {
  if (!chip_->ports().has(port, bit)) {
    throw std::runtime_error("the controller has no pin P" + std::to_string(port) + "." +
                             std::to_string(bit));
  }
  if (!inputs_.empty() && tick < inputs_.back().tick) throw std::runtime_error("DRIVE goes back in time");
  inputs_.push_back({tick, port, bit, level});
}

void Machine::send(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (line_free_at_ < watermark_) line_free_at_ = watermark_;
    Frame frame;
    frame.begins = line_free_at_;
    frame.byte = byte;
    // The receiver takes a byte in the middle of its stop bit.
    frame.done = frame.begins + 19 * asked_.clock_hz / (2 * std::uint64_t{asked_.baud});
    chip_->hear(frame);
    line_free_at_ += pace_.next();
  }
}

void Machine::feedInputs() {
  while (!inputs_.empty() && inputs_.front().tick <= chip_->now()) {
    const Input input = inputs_.front();
    inputs_.pop_front();
    chip_->drive(input.port, input.bit, input.level, input.tick);
  }
}

void Machine::watchRate(double ticks_per_bit) {
  const double rate = static_cast<double>(asked_.clock_hz) / ticks_per_bit;
  if (!misheard_.empty() || !emulator::missesBytes(rate, asked_.baud)) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the firmware's UART runs at %.0f baud, with a clock of %llu Hz, and the bench at %u", rate,
                static_cast<unsigned long long>(asked_.clock_hz), asked_.baud);
  misheard_ = text;
}

void Machine::watchLine() {
  if (asked_.baud == 0) return;
  const Uart& uart = chip_->uart();
  if (uart.begun() != begun_) {
    begun_ = uart.begun();
    const Frame& frame = uart.lastBegun();
    watchRate(frame.ticks_per_bit);
    if (misheard_.empty() && !frame.ninth) {
      misheard_ =
          "a byte of the firmware's UART takes 11 bits, and its ninth bit is 0 where the bench (8N1) expects "
          "the stop bit";
    }
  }
  if (uart.heard() == heard_) return;
  heard_ = uart.heard();
  watchRate(uart.receiveTicksPerBit());
  if (misheard_.empty() && uart.hasHeardTooSoon()) {
    misheard_ = "the firmware's UART listens for bytes of 11 bits, and the bench sends 10 (8N1)";
  }
}

void Machine::settle() {
  feedInputs();
  is_settled_ = !chip_->settle();
  watchLine();
}

/// Whether the firmware has come to an end, or speaks at another rate; the result says so then.
bool Machine::hasEnded(emulator::RunResult& result) {
  if (!chip_->fault().empty()) {
    result.stop = KB_PS_CRASHED;
    result.message = "the firmware crashed at clock " + std::to_string(chip_->now()) + ": " + chip_->fault();
  } else if (!misheard_.empty()) {
    result.stop = KB_PS_MISHEARD;
    result.message = misheard_;
  } else if (chip_->ports().isFlooded()) {
    result.stop = KB_PS_FLOODED;
    result.message = "more than " + std::to_string(asked_.max_events) + " pin events in one quantum";
  } else if (!chip_->end().empty()) {
    result.stop = KB_PS_ENDED;
    result.message = chip_->end();
  }
  return result.stop != KB_PS_REACHED;
}

void Machine::deliver(emulator::RunResult& result, Tick until) {
  result.watermark = result.stop == KB_PS_REACHED ? until : std::clamp<Tick>(chip_->now(), watermark_, until);
  watermark_ = result.watermark;
  result.events = chip_->ports().take(result.watermark);
  for (const Frame& frame : chip_->uart().takeSent()) sent_.push_back(frame);
  while (!sent_.empty() && sent_.front().done <= result.watermark) {
    result.uart.push_back(sent_.front().byte);
    sent_.pop_front();
  }
}

emulator::RunResult Machine::run(std::uint64_t until) {
  emulator::RunResult result;
  while (!hasEnded(result)) {
    if (!is_settled_) {
      if (chip_->now() > until) break;
      settle();
    } else if (chip_->now() >= until) {
      break;
    } else {
      is_settled_ = chip_->run(inputs_.empty() ? until : std::min<Tick>(until, inputs_.front().tick));
      if (is_settled_) watchLine();
    }
  }
  deliver(result, until);
  return result;
}

}  // namespace kerfbench::mcs51_child
