// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>
#include <vector>

#include "hil/base/digest.h"
#include "hil/base/number_from.h"
#include "hil/base/text.h"
#include "hil/source/vcd.h"
#include "hil/source/vcd_scale.h"
#include "hil/source/vcd_words.h"

namespace kerfbench::source {
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 30U;
constexpr std::size_t kMaxFaults = 20;
constexpr std::size_t kMaxWires = 4096;
constexpr std::size_t kLeastBytesForAnEdge = 8;
constexpr std::size_t kMostReserved = std::size_t{1} << 24U;
constexpr std::uint64_t kMaxWidthBits = 4096;

constexpr std::string_view kSumBegin = "$comment kerfbench sum ";

/// Thrown when there is no sense in reading on.
struct GiveUp {};

/// Whether the text up to `begin`, where its sum stands as the last line, is as it was written.
bool sumFits(std::string_view text, std::size_t begin, std::string_view sum) {
  const std::string line = std::string(kSumBegin).append(sum) + " $end";
  const std::string_view last = text.substr(begin);
  return last.starts_with(line) && last.find_first_not_of(" \n", line.size()) == std::string_view::npos &&
         sum == base::sha256(text.substr(0, begin));
}

class Reader {
 public:
  Reader(std::string path, std::string_view text, const SignalMap& map)
      : path_(std::move(path)), text_(text), map_(map) {}

  PinRecording read() {
    try {
      header();
      body();
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
  struct Gap {
    Tick tick{};
    std::uint16_t port{};
  };

  void fault(const std::string& what) {
    if (fault_count_++ == kMaxFaults) {
      faults_ += "\n" + path_ + ": further faults left out";
      throw GiveUp{};
    }
    faults_ += (faults_.empty() ? "" : "\n") + path_ + ":" + std::to_string(line_) + ": " + what;
  }
  [[noreturn]] void giveUp(const std::string& what) {
    fault(what);
    throw GiveUp{};
  }

  /// The next word, or nothing at the end of the file. Words are divided by blanks.
  std::string_view word() {
    const char* const end = text_.data() + text_.size();
    const char* at = text_.data() + at_;
    for (; at != end && static_cast<unsigned char>(*at) <= ' '; ++at) line_ += *at == '\n' ? 1U : 0U;
    const char* const start = at;
    while (at != end && static_cast<unsigned char>(*at) > ' ') ++at;
    at_ = static_cast<std::size_t>(at - text_.data());
    return {start, static_cast<std::size_t>(at - start)};
  }
  /// The words up to $end.
  std::vector<std::string_view> section(std::string_view name) {
    std::vector<std::string_view> words;
    for (;;) {
      const auto next = word();
      if (next.empty()) giveUp(std::string(name) + " has no $end: the file is truncated");
      if (next == "$end") return words;
      section_end_ = next.data() + next.size();
      if (words.size() < 64) words.push_back(next);
    }
  }

  void header() {
    for (;;) {
      const auto keyword = word();
      if (keyword.empty()) giveUp("no $enddefinitions: not a VCD file, or a truncated one");
      if (keyword.front() != '$') giveUp("a VCD header was expected, not " + base::inQuotes(keyword));
      const auto words = section(keyword);
      if (keyword == "$enddefinitions") break;
      if (keyword == "$timescale") timescale(words);
      if (keyword == "$comment") comment(words);
      if (keyword == "$var") variable(words);
    }
    if (exponent_ < 0) {
      fault("no $timescale");
      return;
    }
    for (std::size_t i = 0; i < kSignalCount; ++i) {
      const auto signal = static_cast<Signal>(i);
      if (map_.pin(signal) && !isSensor(signal) && !seen_[i]) {
        fault("no wire " + std::string(signalName(signal)) + ", which the machine has");
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

  void timescale(const std::vector<std::string_view>& words) {
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

  void comment(const std::vector<std::string_view>& words) {
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
        gaps_.push_back({*tick, *port});
      } else {
        fault("a gap makes no sense");
      }
    } else if (words[1] == "problem") {
      const char* const first = words[2].data();
      const auto problem = fromVcdWords({first, static_cast<std::size_t>(section_end_ - first)});
      if (problem) {
        recording_.problems.push_back(*problem);
      } else {
        fault("a problem makes no sense");
      }
    }
  }

  void received(const std::vector<std::string_view>& words) {
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

  void variable(const std::vector<std::string_view>& words) {
    const auto width = words.size() >= 4 ? base::numberFrom<std::uint64_t>(words[1]) : std::nullopt;
    if (!width || *width == 0) return fault("$var needs a type, a width, an identifier and a name");
    if (*width > kMaxWidthBits) return fault("a wire of " + std::to_string(*width) + " bits is too wide");
    if (wires_.size() >= kMaxWires) giveUp("more than " + std::to_string(kMaxWires) + " wires");
    Wire wire{signalFromName(words[3]), *width, {}, {}};
    if (wire.signal && !map_.pin(*wire.signal)) wire.signal.reset();
    if (wire.signal) wire.pin = *map_.pin(*wire.signal);
    if (wire.signal) {
      if (*width != 1) return fault(std::string(words[3]) + " must be a wire of 1 bit");
      if (std::exchange(seen_[static_cast<std::size_t>(*wire.signal)], true)) {
        return fault("the wire " + std::string(words[3]) + " is there twice");
      }
    }
    const auto [place, is_new] = wires_.try_emplace(words[2], wire);
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
    // Memory that is never written costs nothing; a vector that grows is copied.
    recording_.outputs.reserve(std::min(kMostReserved, (text_.size() - at_) / kLeastBytesForAnEdge));
    for (auto token = word(); !token.empty(); token = word()) {
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
            const auto begin = static_cast<std::size_t>(token.data() - text_.data());
            const auto words = section(token);
            if (words.size() >= 3 && words[0] == "kerfbench" && words[1] == "sum")
              sum_fits_ = sumFits(text_, begin, words[2]);
            if (words.size() >= 3 && words[0] == "kerfbench" && words[1] == "uart") received(words);
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
    if (isSensor(*wire.signal)) {
      recording_.sensors.push_back({tick_, *wire.signal, high});
    } else {
      output(wire.pin, high);
    }
  }

  void vector(std::string_view token) {
    const auto id = word();
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

  void output(PinId pin, bool high) {
    auto& level = levels_[pin.port];
    const auto mask = static_cast<std::uint16_t>(1U << pin.bit);
    level = static_cast<std::uint16_t>(high ? level | mask : level & ~mask);
    auto& events = recording_.outputs;
    for (auto event = events.rbegin(); event != events.rend() && event->tick == tick_; ++event) {
      if (event->port != pin.port) continue;
      if ((event->changed & mask) != 0) fault("a wire changes twice at one stamp");
      event->changed |= mask;
      event->level = level;
      return;
    }
    events.push_back({tick_, pin.port, mask, level, PinEvent::kNone});
  }

  void finish() {
    if (!stamped_) giveUp("no time stamps");
    const Tick last = std::max(recording_.outputs.empty() ? 0 : recording_.outputs.back().tick,
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
    for (const auto& gap : gaps_) {
      auto& events = recording_.outputs;
      auto event = std::lower_bound(events.begin(), events.end(), gap.tick,
                                    [](const PinEvent& e, Tick tick) { return e.tick < tick; });
      while (event != events.end() && event->tick == gap.tick && event->port != gap.port) ++event;
      if (event == events.end() || event->tick != gap.tick) {
        // The gap's own edges were on pins that are not wired, but it is still a gap.
        event = events.insert(event, {gap.tick, gap.port, 0, 0, 0});
        if (event != events.begin()) event->level = levelBefore(event - events.begin(), gap.port);
      }
      event->flags |= PinEvent::kGap;
    }
  }

  [[nodiscard]] std::uint16_t levelBefore(std::ptrdiff_t index, std::uint16_t port) const {
    while (--index >= 0) {
      const auto& event = recording_.outputs[static_cast<std::size_t>(index)];
      if (event.port == port) return event.level;
    }
    return 0;
  }

  std::string path_;
  std::string_view text_;
  const SignalMap& map_;
  std::size_t at_{};
  const char* section_end_{};  ///< Behind the last word of the section that was read last.
  std::size_t line_{1};
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
  std::vector<Gap> gaps_;
  std::array<bool, kSignalCount> seen_{};
  std::unordered_map<std::string_view, Wire> wires_;
  std::array<Wire*, 256> by_letter_{};
  std::vector<std::uint16_t> levels_ =
      std::vector<std::uint16_t>(std::size_t{1} << 16U);  ///< Levels of each port.
  VcdScale scale_;
  PinRecording recording_;
  std::uint64_t stamp_{};
  Tick tick_{};
  bool stamped_{};
};

/// A file's text; its memory is written once.
struct FileText {
  std::unique_ptr<char[]> bytes;
  std::size_t size{};
  [[nodiscard]] std::string_view view() const { return {bytes.get(), size}; }
};

FileText readWhole(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto size = file ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (size < 0) throw std::system_error(errno, std::generic_category(), path.string());
  if (static_cast<std::uintmax_t>(size) > kMaxFileBytes)
    throw std::runtime_error(path.string() + ": larger than 4 GiB");
  FileText text{std::make_unique_for_overwrite<char[]>(static_cast<std::size_t>(size)),
                static_cast<std::size_t>(size)};
  file.seekg(0);
  if (!file.read(text.bytes.get(), size))
    throw std::system_error(errno, std::generic_category(), path.string());
  return text;
}

}  // namespace

PinRecording readVcd(const std::filesystem::path& path, const SignalMap& map) {
  const FileText text = readWhole(path);
  return Reader(path.string(), text.view(), map).read();
}

std::optional<std::string> vcdSum(const std::filesystem::path& path) {
  constexpr std::size_t kDigits = 64;
  const FileText file = readWhole(path);
  const std::string_view text = file.view();
  const std::size_t begin = text.rfind(kSumBegin);
  if (begin == std::string_view::npos) return std::nullopt;
  std::string sum(text.substr(begin + kSumBegin.size(), kDigits));
  if (!sumFits(text, begin, sum)) return std::nullopt;
  return sum;
}

}  // namespace kerfbench::source
