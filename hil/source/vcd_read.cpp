// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "hil/base/digest.h"
#include "hil/base/number_from.h"
#include "hil/base/text.h"
#include "hil/source/vcd.h"
#include "hil/source/vcd_digits.h"
#include "hil/source/vcd_instants.h"
#include "hil/source/vcd_scale.h"
#include "hil/source/vcd_text.h"
#include "hil/source/vcd_words.h"

namespace kerfbench::source {
namespace {

constexpr std::size_t kMaxFaults = 20;
constexpr std::size_t kMaxWires = 4096;
constexpr std::size_t kMostStrangers = 16;
constexpr std::uint64_t kMaxWidthBits = 4096;

/// Thrown when there is no sense in reading on.
struct GiveUp {};

using Words = std::vector<std::string_view>;

struct WordHash {
  using is_transparent = void;
  std::size_t operator()(std::string_view word) const { return std::hash<std::string_view>()(word); }
};

class Reader {
 public:
  Reader(const std::filesystem::path& path, const SignalMap& map, const ChannelNames& names,
         const SpareSignals& spare, const base::ProgressFn& progress)
      : path_(path.string()), text_(path, progress), map_(map), names_(names), spare_(spare) {}

  PinRecording read() {
    try {
      header();
      body();
    } catch (const std::length_error& e) {
      if (fault_count_ < kMaxFaults) fault(e.what());
    } catch (const GiveUp&) {
    }
    if (!faults_.empty()) throw std::runtime_error(faults_);
    return std::move(recording_);
  }

 private:
  struct Wire {
    std::optional<Signal> signal;
    std::uint64_t width{};
    PinId pin{};                  ///< Where the machine has the signal.
    std::optional<bool> level{};  ///< nullopt: none was given yet, which is low.
  };
  void fault(const std::string& what) {
    if (fault_count_++ == kMaxFaults) {
      faults_ += "\n" + path_ + ": further faults left out";
      throw GiveUp{};
    }
    faults_ += (faults_.empty() ? "" : "\n") + path_ + ":" + std::to_string(text_.line()) + ": " + what;
  }
  [[noreturn]] void giveUp(const std::string& what) {
    fault(what);
    throw GiveUp{};
  }

  VcdText::Section section(std::string_view keyword) {
    const std::string name(keyword);
    auto read = text_.section(keyword);
    if (!read) giveUp(name + " has no $end: the file is truncated");
    return std::move(*read);
  }

  void header() {
    for (bool begun = false;;) {
      const auto keyword = text_.word();
      if (keyword.empty()) giveUp("no $enddefinitions: not a VCD file, or a truncated one");
      // Words of a file that is no recording at all are nobody's business.
      if (keyword.front() != '$' && !begun)
        giveUp("begins with no section of a header: it is no VCD recording");
      if (keyword.front() != '$') giveUp("a VCD header was expected, not " + base::inQuotes(keyword));
      begun = true;
      const auto section = this->section(keyword);
      const std::string_view name = section.whole.substr(0, keyword.size());
      if (name == "$enddefinitions") break;
      if (name == "$timescale") timescale(section.words);
      if (name == "$comment") comment(section);
      if (name == "$var") variable(section.words);
    }
    if (!has_sum_) text_.forgetDigest();
    if (exponent_ < 0) {
      fault("no $timescale");
      return;
    }
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const auto signal = static_cast<Signal>(i);
      if (isNeeded(signal) && !seen_[i]) {
        fault("no wire " + nameOf(signal) + ", which the machine has" + std::exchange(strangers_, {}));
      }
      if (isSensor(signal) && seen_[i]) recording_.sensor_wires.push_back(signal);
    }
    TickRate rate{1, 1};
    for (int i = 0; i < exponent_; ++i) rate.den *= 10;
    recording_.own = own_rate_.has_value();
    recording_.rate = own_rate_.value_or(rate);
    recording_.stamp_err_ticks = own_stamp_err_.value_or(recording_.own ? 0 : 1);
    scale_ = VcdScale(exponent_, recording_.rate);
    if (recording_.own && !scale_.exact() && exponent_ < 12)
      fault("the time scale is too coarse for the tick");
  }

  void timescale(const Words& words) {
    std::string text;
    for (const auto part : words) text.append(part.substr(0, 16));
    static constexpr std::array<const char*, 6> kUnits{"s", "ms", "us", "ns", "ps", "fs"};
    for (int exponent = -2; exponent <= VcdScale::kFinestExponent; ++exponent) {
      const int unit = (exponent + 2) / 3;
      const int zeros = unit * 3 - exponent;
      if (text != std::string(zeros == 0   ? "1"
                              : zeros == 1 ? "10"
                                           : "100") +
                      kUnits[static_cast<std::size_t>(unit)]) {
        continue;
      }
      if (exponent_ >= 0) fault("a second $timescale");
      if (exponent < 0) fault("a time scale above one second");
      exponent_ = std::max(exponent, 0);
      return;
    }
    fault("$timescale " + base::inQuotes(text) + " is not 1, 10 or 100 of s … fs");
  }

  void comment(const VcdText::Section& section) {
    const Words& words = section.words;
    if (words.size() < 3 || words[0] != "kerfbench") return;
    if (words[1] == "tick") {
      const auto slash = words[2].find('/');
      const auto num = base::numberFrom<std::uint64_t>(words[2].substr(0, slash));
      const auto den = slash == std::string_view::npos
                           ? std::nullopt
                           : base::numberFrom<std::uint64_t>(words[2].substr(slash + 1));
      constexpr std::uint64_t kMax = std::uint64_t{1} << 40U;
      if (!num || !den || *num == 0 || *den == 0 || *num > kMax || *den > kMax) {
        fault("a tick of " + base::inQuotes(words[2]) + " seconds makes no sense");
      } else if (own_rate_) {
        fault("a second tick");
      } else {
        own_rate_ = TickRate{*num, *den};
      }
    } else if (words[1] == "end") {
      own_end_ = base::numberFrom<Tick>(words[2]);
      if (!own_end_) fault("an end of " + base::inQuotes(words[2]) + " makes no sense");
    } else if (words[1] == "sum") {
      has_sum_ = true;
    } else if (words[1] == "stamp_err") {
      own_stamp_err_ = base::numberFrom<std::uint32_t>(words[2]);
      if (!own_stamp_err_) fault("an error of " + base::inQuotes(words[2]) + " ticks makes no sense");
    } else if (words[1] == "words") {
      own_words_ = base::numberFrom<std::size_t>(words[2]);
      if (!own_words_) fault("a number of words of " + base::inQuotes(words[2]) + " makes no sense");
    } else if (words[1] == "gap") {
      const auto tick = base::numberFrom<Tick>(words[2]);
      const auto port = words.size() > 3 ? base::numberFrom<std::uint16_t>(words[3]) : std::nullopt;
      if (tick && port) {
        instants_.gaps().add(*tick, *port);
      } else {
        fault("a gap makes no sense");
      }
    } else if (words[1] == "problem") {
      const auto problem =
          fromVcdWords(section.text.substr(static_cast<std::size_t>(words[2].data() - section.text.data())));
      if (problem) {
        recording_.problems.push_back(*problem);
      } else {
        fault("a problem makes no sense");
      }
    }
  }

  void received(const Words& words) {
    const auto tick = base::numberFrom<Tick>(words[2]);
    const std::string_view hex = words.size() > 3 ? words[3] : "";
    ReceivedBytes bytes{tick.value_or(0), {}};
    bool good = tick && !hex.empty() && hex.size() % 2 == 0 &&
                (recording_.uart.empty() || *tick > recording_.uart.back().tick);
    for (std::size_t i = 0; good && i < hex.size(); i += 2) {
      std::uint8_t byte = 0;
      const auto done = std::from_chars(hex.data() + i, hex.data() + i + 2, byte, 16);
      good = done.ec == std::errc{} && done.ptr == hex.data() + i + 2;
      bytes.bytes.push_back(byte);
    }
    if (good) {
      recording_.uart.push_back(std::move(bytes));
    } else {
      fault("bytes of a UART make no sense");
    }
  }

  /// Names of a foreign file; those of Kerfbench's own have the signals' names.
  [[nodiscard]] const ChannelNames& names() const {
    static const ChannelNames kNone;
    return own_rate_ ? kNone : names_;
  }

  /// Files of Kerfbench's own have every wire of the machine; others may lack what it has no use for.
  [[nodiscard]] bool isNeeded(Signal signal) const {
    const bool is_spare = !own_rate_ && std::ranges::find(spare_, signal) != spare_.end();
    return map_.hasOwnWire(signal) && !isSensor(signal) && !is_spare;
  }

  [[nodiscard]] std::string nameOf(Signal signal) const {
    const auto named = std::ranges::find(names(), signal, &ChannelNames::value_type::first);
    const std::string own(signalName(signal));
    return named == names().end() ? own : base::printable(named->second) + " (" + own + ")";
  }

  [[nodiscard]] std::optional<Signal> signalOf(std::string_view wire) const {
    const auto named = std::ranges::find(names(), wire, &ChannelNames::value_type::second);
    if (named != names().end()) return named->first;
    const std::optional<Signal> signal = signalFromName(wire);
    const bool is_elsewhere =
        signal && std::ranges::find(names(), *signal, &ChannelNames::value_type::first) != names().end();
    return is_elsewhere ? std::nullopt : signal;
  }

  /// Wires that are no signal's: of a foreign file it is among them.
  void addStranger(std::string_view wire) {
    if (++stranger_count_ > kMostStrangers + 1) return;
    if (stranger_count_ == kMostStrangers + 1) {
      strangers_ += " …";
      return;
    }
    strangers_ += (strangers_.empty()
                       ? "; wires of the file that are no signal's (the scenario's key wires names them): "
                       : ", ") +
                  base::printable(wire);
  }

  void variable(const Words& words) {
    const auto width = words.size() >= 4 ? base::numberFrom<std::uint64_t>(words[1]) : std::nullopt;
    if (!width || *width == 0) return fault("$var needs a type, a width, an identifier and a name");
    if (*width > kMaxWidthBits) return fault("a wire of " + std::to_string(*width) + " bits is too wide");
    if (wires_.size() >= kMaxWires) giveUp("more than " + std::to_string(kMaxWires) + " wires");
    Wire wire{signalOf(words[3]), *width, {}, {}};
    if (!wire.signal) addStranger(words[3]);
    if (wire.signal && !map_.hasOwnWire(*wire.signal)) wire.signal.reset();
    if (wire.signal) wire.pin = *map_.pin(*wire.signal);
    if (wire.signal) {
      if (*width != 1) return fault(std::string(words[3]) + " must be a wire of 1 bit");
      if (std::exchange(seen_[static_cast<std::size_t>(*wire.signal)], true)) {
        return fault("the wire " + std::string(words[3]) + " is there twice");
      }
    }
    const auto [place, is_new] = wires_.try_emplace(std::string(words[2]), wire);
    if (!is_new && wire.signal) fault("the identifier " + base::inQuotes(words[2]) + " is used twice");
    if (is_new && words[2].size() == 1)
      by_letter_[static_cast<unsigned char>(words[2].front())] = &place->second;
  }

  /// Null if there is none. Most identifiers are single letters.
  Wire* wireOf(std::string_view id) {
    if (id.size() == 1) return by_letter_[static_cast<unsigned char>(id.front())];
    const auto found = wires_.find(id);
    return found == wires_.end() ? nullptr : &found->second;
  }

  void body() {
    if (!faults_.empty()) return;  // Nothing below can be judged by a broken header.
    for (auto token = nextWord(); !token.empty(); token = nextWord()) {
      switch (token.front()) {
        case '#':
          stamp(token.substr(1));
          break;
        case '0':
        case '1':
        case 'x':
        case 'X':
        case 'z':
        case 'Z':
          if (token.size() == 1) {
            fault("a change without an identifier");
          } else {
            change(token.front(), token.substr(1));
          }
          break;
        case 'b':
        case 'B':
        case 'r':
        case 'R':
          vector(token);
          break;
        case '$':
          if (token == "$comment") {
            said(section(token));
          } else if (token == "$end" || token.starts_with("$dump")) {
            in_dump_ = token != "$end";
          } else {
            fault("unknown section " + base::inQuotes(token));
          }
          break;
        default:
          fault("neither a stamp nor a change: " + base::inQuotes(token));
      }
    }
    finish();
  }

  void said(const VcdText::Section& section) {
    const Words& words = section.words;
    if (words.size() < 3 || words[0] != "kerfbench") return;
    if (words[1] == "uart") received(words);
    if (words[1] != "sum" || !has_sum_) return;
    // What stands there later is as good as a line that was changed.
    const std::string sum(words[2]);
    const bool is_line = std::string(section.whole) + "\n" == vcdSumLine(sum);
    sum_fits_ = is_line && text_.digestBefore(section.whole.data()) == sum && text_.onlyBlanksFollow();
  }

  void stamp(std::string_view digits) {
    const auto value = base::numberFrom<std::uint64_t>(digits);
    if (!value) return fault("a stamp of " + base::inQuotes(digits) + " makes no sense");
    if (stamped_ && *value < stamp_) return fault("time goes back to " + std::to_string(*value));
    stamp_ = *value;
    stamped_ = true;
    if (!scale_.tickOf(stamp_, tick_)) fault("the stamp " + std::to_string(stamp_) + " is not on a tick");
  }

  void change(char level, std::string_view id) {
    Wire* const found = wireOf(id);
    if (found == nullptr) return fault("unknown identifier " + base::inQuotes(id));
    Wire& wire = *found;
    if (!wire.signal) return;
    if (level != '0' && level != '1') {
      return fault(std::string(signalName(*wire.signal)) + " has the level '" + std::string(1, level) +
                   "': nobody knows what the pin did");
    }
    const bool high = level == '1';
    const bool was_given = wire.level.has_value();
    if (high == std::exchange(wire.level, high).value_or(false)) {
      if (was_given && !in_dump_) {
        fault(std::string(signalName(*wire.signal)) + " changes to " + level +
              ", which it is: an edge is missing, or is there twice");
      }
      return;
    }
    edge(wire, high);
  }

  void edge(const Wire& wire, bool high) {
    if (isSensor(*wire.signal)) {
      recording_.sensors.push_back({tick_, *wire.signal, high});
    } else if (!instants_.change(wire.pin, high, tick_)) {
      fault("a wire changes twice at one stamp");
    }
  }

  std::string_view nextWord() {
    readPlainLines();
    return text_.word();
  }

  /// Reads on while lines are of the usual kind, a stamp or a change of a wire of one letter, and at hand.
  /// Whatever else a file may hold, and all that is wrong with it, is left to those who read words.
  void readPlainLines() {
    constexpr std::size_t kLongest = 1 + Digits::kRead;
    if (text_.ahead().starts_with('\n')) text_.skipLine(1);
    while (text_.ahead().size() > kLongest) {
      const char* const line = text_.ahead().data();
      const std::size_t size = *line == '#' ? plainStamp(line) : plainChange(line);
      if (size == 0) break;
      text_.skipLine(size);
    }
  }

  /// Bytes of a line with a stamp that follows the last one; 0: it is none, and nothing was done.
  std::size_t plainStamp(const char* line) {
    const Digits digits = digitsAt(line + 1);
    const bool is_number = digits.count - 1 < Digits::kMost && line[1 + digits.count] == '\n';
    if (!is_number || digits.value < stamp_ || !scale_.tickOf(digits.value, tick_)) return 0;
    stamp_ = digits.value;
    stamped_ = true;
    return digits.count + 2;
  }

  /// Bytes of a line in which a wire changes its level; 0: it is none, and nothing was done.
  std::size_t plainChange(const char* line) {
    constexpr std::size_t kBytes = 3;
    Wire* const wire = by_letter_[static_cast<unsigned char>(line[1])];
    const bool high = line[0] == '1';
    if (wire == nullptr || line[2] != '\n' || (!high && line[0] != '0')) return 0;
    if (!wire->signal) return kBytes;
    if (wire->level != !high) return 0;
    wire->level = high;
    edge(*wire, high);
    return kBytes;
  }

  void vector(std::string_view value) {
    const std::string token(value);
    const auto id = text_.word();
    if (id.empty()) giveUp("a change without an identifier: the file is truncated");
    const Wire* const found = wireOf(id);
    if (found == nullptr) return fault("unknown identifier " + base::inQuotes(id));
    if (token.size() > kMaxWidthBits + 1)
      return fault("a value of " + std::to_string(token.size()) + " characters");
    if (found->signal) {
      if (token.size() != 2) return fault("a wire of 1 bit has the value " + base::inQuotes(token));
      change(token[1], id);
    }
  }

  void finish() {
    if (!stamped_) giveUp("no time stamps");
    const Tick last = std::max(instants_.flushed().back().tick,
                               recording_.sensors.empty() ? 0 : recording_.sensors.back().tick);
    recording_.end = own_end_.value_or(tick_);
    if (own_end_ && (*own_end_ < last || tick_ < *own_end_))
      fault("the file ends before its end: it is truncated");
    if (recording_.uart.size() != own_words_.value_or(recording_.uart.size()))
      fault("not all of the controller's words are there: it is truncated");
    if (has_sum_ && !sum_fits_)
      recording_.problems.emplace_back(
          "the recording is not as it was written: the sum at its end does not fit what stands before it");
    recording_.sealed = has_sum_;
    instants_.putRestOfGaps();
    recording_.outputs = std::move(instants_.flushed());
  }

  std::string path_;
  VcdText text_;
  const SignalMap& map_;
  const ChannelNames& names_;
  const SpareSignals& spare_;
  std::string strangers_;  ///< Wires that are no signal's, for a fault; empty once it was told.
  std::size_t stranger_count_{};
  std::string faults_;
  std::size_t fault_count_{};
  int exponent_{-1};
  std::optional<TickRate> own_rate_;
  std::optional<Tick> own_end_;
  std::optional<std::size_t> own_words_;
  std::optional<std::uint32_t> own_stamp_err_;
  bool in_dump_{};  ///< Levels of a $dump section are told, changed or not.
  bool has_sum_{};  ///< The header says that the file ends with its own sum.
  bool sum_fits_{};
  VcdInstants instants_;
  std::array<bool, kSignalCount> seen_{};
  std::unordered_map<std::string, Wire, WordHash, std::equal_to<>> wires_;
  std::array<Wire*, 256> by_letter_{};
  VcdScale scale_;
  PinRecording recording_;
  std::uint64_t stamp_{};
  Tick tick_{};
  bool stamped_{};
};

}  // namespace

PinRecording readVcd(const std::filesystem::path& path, const SignalMap& map, const ChannelNames& names,
                     const SpareSignals& spare, const base::ProgressFn& progress) {
  return Reader(path, map, names, spare, progress).read();
}

}  // namespace kerfbench::source
