// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/job/target.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/controller/release.h"
#include "firmware_under_test/planner/job/job.h"
#include "hil/base/input_file.h"

namespace kerfbench::planner {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// An image has its symbols with it, a release for this computer all of a C library.
constexpr std::uint64_t kLargestImage_bytes = std::uint64_t{64} << 20U;

std::uint64_t numberAt(std::span<const std::uint8_t> block, std::size_t at, std::size_t bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes; i-- > 0;) value = value << 8 | block[at + i];
  return value;
}

std::string textAt(std::span<const std::uint8_t> block, std::size_t at, std::size_t length) {
  std::string text;
  for (std::size_t i = 0; i < length && block[at + i] != 0; ++i) {
    const std::uint8_t c = block[at + i];
    text += c >= 0x20 && c < 0x7F ? static_cast<char>(c) : '?';
  }
  return text;
}

std::optional<unsigned> hexByte(const std::string& line, std::size_t at) {
  const auto digit = [&](std::size_t i) {
    const char* const digits = "0123456789ABCDEF";
    const char* const found =
        i < line.size() ? std::strchr(digits, std::toupper(static_cast<unsigned char>(line[i]))) : nullptr;
    return found != nullptr && *found != 0 ? static_cast<int>(found - digits) : -1;
  };
  const int high = digit(at);
  const int low = digit(at + 1);
  if (high < 0 || low < 0) return std::nullopt;
  return static_cast<unsigned>(high * 16 + low);
}

/// Bytes of an Intel hex file in the order of their addresses, gaps left out.
Bytes bytesOfHex(const std::string& text, const std::string& name) {
  std::map<std::uint32_t, std::uint8_t> memory;
  std::uint32_t base = 0;
  int number = 0;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    std::string line = text.substr(from, end - from);
    from = end + 1;
    ++number;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty()) continue;
    const auto refuse = [&](const char* why) {
      throw PlanError(fmt::format("{}: line {}: {}", name, number, why));
    };
    std::vector<unsigned> record;
    for (std::size_t i = 1; i + 1 < line.size() + 1 && i < line.size(); i += 2) {
      const auto byte = hexByte(line, i);
      if (!byte) refuse("no Intel hex record");
      record.push_back(*byte);
    }
    if (line[0] != ':' || record.size() < 5 || record.size() != record[0] + 5U) refuse("no Intel hex record");
    unsigned sum = 0;
    for (const unsigned byte : record) sum += byte;
    if ((sum & 0xFFU) != 0) refuse("its checksum is wrong");
    const std::uint32_t address = record[1] << 8 | record[2];
    const unsigned type = record[3];
    if (type == 0) {
      for (unsigned i = 0; i < record[0]; ++i)
        memory[base + address + i] = static_cast<std::uint8_t>(record[4 + i]);
    } else if ((type == 2 || type == 4) && record[0] == 2) {
      base = (record[4] << 8 | record[5]) << (type == 2 ? 4U : 16U);
    } else if (type == 1) {
      break;
    }
  }
  Bytes bytes;
  for (const auto& [address, byte] : memory) bytes.push_back(byte);
  return bytes;
}

}  // namespace

std::optional<Target> targetFrom(std::span<const std::uint8_t> block) {
  constexpr std::size_t kMagic = sizeof(KB_RELEASE_MAGIC) - 1;
  if (block.size() < KB_RELEASE_LEN || std::memcmp(block.data(), KB_RELEASE_MAGIC, kMagic) != 0 ||
      block[kMagic] != KB_RELEASE_LAYOUT)
    return std::nullopt;
  const double hz = static_cast<double>(numberAt(block, 9, 4));
  const auto seconds = [&](std::size_t at) { return static_cast<double>(numberAt(block, at, 2)) / hz; };
  Target target;
  target.tick_s = seconds(13);
  target.ticks_per_period = block[15];
  target.max_steps = block[16];
  target.baud = static_cast<std::uint32_t>(numberAt(block, 19, 4));
  target.longest_delay_ticks = static_cast<int>(numberAt(block, 23, 2));
  target.setup_s = seconds(25);
  target.hold_s = seconds(27);
  target.width_s = seconds(29);
  target.space_s = seconds(31);
  target.late_s = seconds(33);
  target.name = textAt(block, 35, KB_RELEASE_NAME_LEN);
  target.version = textAt(block, 47, KB_RELEASE_VERSION_LEN);
  const bool sane = hz > 0.0 && target.tick_s > 0.0 && target.ticks_per_period > 0 && target.max_steps > 1 &&
                    target.max_steps <= 127 && target.baud > 0;
  return sane ? std::optional(target) : std::nullopt;
}

std::optional<Target> findTarget(const std::filesystem::path& image) {
  const base::InputContent content = base::readInput(image, kLargestImage_bytes);
  if (!content.bytes) throw PlanError(image.string() + ": " + content.refusal);
  const std::string& text = *content.bytes;
  const std::string ending = image.extension().string();
  const bool hex = ending == ".hex" || ending == ".ihx";
  const Bytes bytes = hex ? bytesOfHex(text, image.string()) : Bytes(text.begin(), text.end());
  const std::string magic = std::string(KB_RELEASE_MAGIC) + static_cast<char>(KB_RELEASE_LAYOUT);
  std::optional<Target> found;
  for (auto at = bytes.begin();; ++at) {
    at = std::search(at, bytes.end(), magic.begin(), magic.end());
    if (at == bytes.end()) break;
    const auto target = targetFrom(std::span(at, bytes.end()));
    if (!target) continue;
    if (found) throw PlanError(image.string() + ": holds more than one description of a controller");
    found = target;
  }
  return found;
}

Target targetOfImage(const std::filesystem::path& image) {
  const std::optional<Target> found = findTarget(image);
  if (!found)
    throw PlanError(
        image.string() +
        ": holds no description of its controller (controller/release.h): nothing can be planned for it");
  return *found;
}

std::string describe(const Target& target) {
  return fmt::format(
      "{}, {}: ticks of {:g} us, {} in a period, at most {} steps; PUL active {:g} us and idle {:g} us, DIR "
      "stable {:g} us before and "
      "{:g} us after; {} baud",
      target.version.empty() ? "unversioned" : target.version, target.name,
      target.tick_s * kMicrosecondsPerSecond, target.ticks_per_period, target.max_steps,
      target.width_s * kMicrosecondsPerSecond, target.space_s * kMicrosecondsPerSecond,
      target.setup_s * kMicrosecondsPerSecond, target.hold_s * kMicrosecondsPerSecond, target.baud);
}

std::string differenceOf(const Target& wanted, const Target& found) {
  std::vector<std::string> parts;
  const auto compare = [&](const char* what, double planned, double is, double unit, const char* unit_name) {
    if (std::abs(planned - is) > 1e-9 * std::abs(planned) + 1e-15)
      parts.push_back(
          fmt::format("{} of {:g}{}, not {:g}{}", what, is / unit, unit_name, planned / unit, unit_name));
  };
  compare("ticks", wanted.tick_s, found.tick_s, 1e-6, " us");
  compare("periods", wanted.periodS(), found.periodS(), 1e-6, " us");
  compare("at most steps per period", wanted.max_steps, found.max_steps, 1.0, "");
  compare("a longest gate delay", wanted.longest_delay_ticks, found.longest_delay_ticks, 1.0, " ticks");
  compare("DIR set-up", wanted.setup_s, found.setup_s, 1e-6, " us");
  compare("DIR hold", wanted.hold_s, found.hold_s, 1e-6, " us");
  compare("PUL width", wanted.width_s, found.width_s, 1e-6, " us");
  compare("PUL space", wanted.space_s, found.space_s, 1e-6, " us");
  compare("ticks that are late by", wanted.late_s, found.late_s, 1e-6, " us");
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace kerfbench::planner
