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
#include "hil/base/progress.h"
#include "hil/source/vcd.h"
#include "hil/source/vcd_scale.h"
#include "hil/source/vcd_text.h"
#include "hil/source/vcd_words.h"

namespace kerfbench::source {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18U;
constexpr std::uint64_t kBytesOfAnEvent = 15;  // About 12 characters a stamp and 3 a change.

/// Enables have the letters after all others: a recording without them has the bytes that it had before there
/// were any.
char identifier(Signal signal) {
  constexpr int kFirst = static_cast<int>(Signal::kGalvoXEnable);
  constexpr int kEnables = static_cast<int>(Signal::kFeedEnable) + 1 - kFirst;
  const int place = static_cast<int>(signal);
  const int letter = isEnable(signal) ? place + static_cast<int>(kSignalCount) - kFirst - kEnables
                     : place < kFirst ? place
                                      : place - kEnables;
  return static_cast<char>('!' + letter);
}

class Writer {
 public:
  Writer(const std::filesystem::path& path, const PinRecording& recording, const SignalMap& map,
         const base::ProgressFn& progress)
      : recording_(recording),
        map_(map),
        file_(path),
        progress_(progress, "writing " + path.filename().string(),
                  kBytesOfAnEvent * (recording.outputs.size() + recording.sensors.size())) {
    scale_ = VcdScale::forRate(recording.rate);
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const auto signal = static_cast<Signal>(i);
      const auto pin = map.pin(signal);
      if (!pin || !map.hasOwnWire(signal)) continue;
      wired_.push_back(signal);
      if (!isSensor(signal)) outputs_.push_back({signal, *pin});
    }
    text_.reserve(kPiece + 4096);
  }

  /// Returns the sum of all but the last line, in which it stands.
  std::string write() {
    header();
    const auto sensors = recording_.sensors.streamed();
    auto sensor = sensors.begin();
    std::uint64_t events = 0;
    for (const auto& event : recording_.outputs) {
      for (; sensor != sensors.end() && sensor->tick < event.tick; ++sensor) writeSensor(*sensor);
      writeOutput(event);
      progress_.done(++events * kBytesOfAnEvent);
    }
    for (; sensor != sensors.end(); ++sensor) writeSensor(*sensor);
    // sigrok drops what happens at the last stamp.
    const Tick last = stamped_ ? tick_ + 1 : 0;
    stamp(std::max(recording_.end, last));
    words();
    flush();
    std::string sum = digest_.digest();
    file_.write(vcdSumLine(sum));
    file_.commit();
    return sum;
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
      endLine();
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

  void flush() {
    digest_.add(text_);
    file_.write(text_);
    text_.clear();
  }
  void endLine() {
    if (text_.size() >= kPiece) flush();
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
      endLine();
    }
  }

  void writeOutput(const PinEvent& event) {
    for (const auto& [signal, pin] : outputs_) {
      if (pin.port != event.port || (event.changed >> pin.bit & 1U) == 0) continue;
      stamp(event.tick);
      change(signal, (event.level >> pin.bit & 1U) != 0);
    }
  }
  void writeSensor(const SensorEdge& edge) {
    if (!map_.pin(edge.signal)) return;
    stamp(edge.tick);
    change(edge.signal, edge.level);
  }
  void change(Signal signal, bool level) {
    text_ += level ? '1' : '0';
    text_ += identifier(signal);
    text_ += '\n';
    endLine();
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
  base::AtomicFile file_;
  base::ShareProgress progress_;
  base::Sha256 digest_;
  std::string text_;  ///< Not yet written.
  Tick tick_{};
  bool stamped_{};
};

}  // namespace

std::string writeVcd(const std::filesystem::path& path, const PinRecording& recording, const SignalMap& map,
                     const base::ProgressFn& progress) {
  return Writer(path, recording, map, progress).write();
}

}  // namespace kerfbench::source
