// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/source/vcd.h"
#include "hil/source/vcd_scale.h"
#include "hil/source/vcd_words.h"

namespace kerfbench::source {
namespace {

char identifier(Signal signal) { return static_cast<char>('!' + static_cast<int>(signal)); }

class Writer {
 public:
  Writer(const PinRecording& recording, const SignalMap& map) : recording_(recording), map_(map) {
    scale_ = VcdScale::forRate(recording.rate);
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const auto signal = static_cast<Signal>(i);
      const auto pin = map.pin(signal);
      if (!pin) continue;
      wired_.push_back(signal);
      if (!isSensor(signal)) outputs_.push_back({signal, *pin});
    }
    // About 12 characters a stamp and 3 a change.
    text_.reserve(4096 + recording.outputs.size() * 22 + recording.sensors.size() * 18);
  }

  /// The file's text without its last line, the sum.
  std::string write() {
    header();
    std::size_t sensor = 0;
    for (const auto& event : recording_.outputs) {
      while (sensor < recording_.sensors.size() && recording_.sensors[sensor].tick < event.tick)
        writeSensor(sensor++);
      writeOutput(event);
    }
    while (sensor < recording_.sensors.size()) writeSensor(sensor++);
    // sigrok drops what happens at the last stamp.
    const Tick last = stamped_ ? tick_ + 1 : 0;
    stamp(std::max(recording_.end, last));
    words();
    return std::move(text_);
  }

 private:
  void header() {
    text_ += "$version kerfbench $end\n$comment kerfbench tick " + std::to_string(recording_.rate.num) + "/" +
             std::to_string(recording_.rate.den) + " $end\n$comment kerfbench end " +
             std::to_string(recording_.end) + " $end\n$comment kerfbench sum sha256 $end\n";
    if (recording_.stamp_err_ticks > 0)
      text_ += "$comment kerfbench stamp_err " + std::to_string(recording_.stamp_err_ticks) + " $end\n";
    if (!recording_.uart.empty())
      text_ += "$comment kerfbench words " + std::to_string(recording_.uart.size()) + " $end\n";
    for (const auto& event : recording_.outputs) {
      if ((event.flags & PinEvent::kGap) == 0) continue;
      text_ += "$comment kerfbench gap " + std::to_string(event.tick) + " " + std::to_string(event.port) +
               " $end\n";
    }
    for (const std::string& problem : recording_.problems)
      text_ += "$comment kerfbench problem " + vcdWords(problem) + " $end\n";
    text_ += "$timescale " + scale_.text() + " $end\n$scope module pins $end\n";
    for (const auto signal : wired_) {
      text_ += std::string("$var wire 1 ") + identifier(signal) + " " + std::string(signalName(signal)) +
               " $end\n";
    }
    text_ += "$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n";
    for (const auto signal : wired_) change(signal, false);
    text_ += "$end\n";
  }

  // At the end: sigrok reads a header again and again while it grows.
  void words() {
    for (const auto& [tick, bytes] : recording_.uart) {
      text_ += "$comment kerfbench uart " + std::to_string(tick) + " ";
      static constexpr std::string_view kDigits = "0123456789abcdef";
      for (const std::uint8_t byte : bytes) {
        text_ += kDigits[byte >> 4U];
        text_ += kDigits[byte & 15U];
      }
      text_ += " $end\n";
    }
  }

  void writeOutput(const PinEvent& event) {
    for (const auto& [signal, pin] : outputs_) {
      if (pin.port != event.port || (event.changed >> pin.bit & 1U) == 0) continue;
      stamp(event.tick);
      change(signal, (event.level >> pin.bit & 1U) != 0);
    }
  }
  void writeSensor(std::size_t index) {
    const auto& edge = recording_.sensors[index];
    if (!map_.pin(edge.signal)) return;
    stamp(edge.tick);
    change(edge.signal, edge.level);
  }
  void change(Signal signal, bool level) {
    text_ += level ? '1' : '0';
    text_ += identifier(signal);
    text_ += '\n';
  }
  void stamp(Tick tick) {
    if (tick < tick_) throw std::invalid_argument("writeVcd: events are not in order of tick");
    if (tick == tick_) {
      stamped_ = true;
      return;
    }
    tick_ = tick;
    stamped_ = true;
    std::array<char, 24> digits{};
    const auto done = std::to_chars(digits.data(), digits.data() + digits.size(), scale_.stampOf(tick));
    text_ += '#';
    text_.append(digits.data(), done.ptr);
    text_ += '\n';
  }

  const PinRecording& recording_;
  const SignalMap& map_;
  VcdScale scale_;
  struct Output {
    Signal signal;
    PinId pin;
  };
  std::vector<Signal> wired_;
  std::vector<Output> outputs_;
  std::string text_;
  Tick tick_{};
  bool stamped_{};
};

}  // namespace

std::string writeVcd(const std::filesystem::path& path, const PinRecording& recording, const SignalMap& map) {
  std::string text = Writer(recording, map).write();
  const std::string sum = base::sha256(text);
  text += "$comment kerfbench sum " + sum + " $end\n";
  base::writeFileAtomically(path, text);
  return sum;
}

}  // namespace kerfbench::source
