// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/parts.h"

#include <algorithm>
#include <array>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kKiB = 1024;
constexpr unsigned kPortBits = 16;
constexpr std::uint32_t kMediumDensity = 0x410, kHighDensity = 0x414;

constexpr std::array<Part, 13> kParts{{
    {"stm32f103c8 stm32f103c8t6", 64 * kKiB, 20 * kKiB, kKiB, "ABCD", "1234", "123", kMediumDensity},
    {"stm32f103cb stm32f103cbt6", 128 * kKiB, 20 * kKiB, kKiB, "ABCD", "1234", "123", kMediumDensity},
    {"stm32f103r8 stm32f103r8t6", 64 * kKiB, 20 * kKiB, kKiB, "ABCD", "1234", "123", kMediumDensity},
    {"stm32f103rb stm32f103rbt6", 128 * kKiB, 20 * kKiB, kKiB, "ABCD", "1234", "123", kMediumDensity},
    {"stm32f103rc stm32f103rct6", 256 * kKiB, 48 * kKiB, 2 * kKiB, "ABCD", "1234", "123", kHighDensity},
    {"stm32f103rd stm32f103rdt6", 384 * kKiB, 64 * kKiB, 2 * kKiB, "ABCD", "1234", "123", kHighDensity},
    {"stm32f103re stm32f103ret6", 512 * kKiB, 64 * kKiB, 2 * kKiB, "ABCD", "1234", "123", kHighDensity},
    {"stm32f103v8 stm32f103v8t6", 64 * kKiB, 20 * kKiB, kKiB, "ABCDE", "1234", "123", kMediumDensity},
    {"stm32f103vb stm32f103vbt6", 128 * kKiB, 20 * kKiB, kKiB, "ABCDE", "1234", "123", kMediumDensity},
    {"stm32f103vc stm32f103vct6", 256 * kKiB, 48 * kKiB, 2 * kKiB, "ABCDE", "1234", "123", kHighDensity},
    {"stm32f103ve stm32f103vet6", 512 * kKiB, 64 * kKiB, 2 * kKiB, "ABCDE", "1234", "123", kHighDensity},
    {"stm32f103zc stm32f103zct6", 256 * kKiB, 48 * kKiB, 2 * kKiB, "ABCDEFG", "1234", "123", kHighDensity},
    {"stm32f103ze stm32f103zet6", 512 * kKiB, 64 * kKiB, 2 * kKiB, "ABCDEFG", "1234", "123", kHighDensity},
}};

bool isCalled(const Part& part, std::string_view name) {
  for (std::string_view rest = part.names;;) {
    const std::size_t blank = rest.find(' ');
    if (!name.empty() && rest.substr(0, blank) == name) return true;
    if (blank == std::string_view::npos) return false;
    rest.remove_prefix(blank + 1);
  }
}

std::string describe(const Part& part) {
  std::string line(part.names);
  line += "\t" + std::to_string(part.flash_bytes) + "\t" + std::to_string(part.sram_bytes) + "\t0";
  for (const std::string_view names : {part.ports, part.timers, part.usarts})
    line += "\t" + std::string(names);
  return line + "\t" + std::to_string(kPortBits) + "\n";
}

}  // namespace

const Part* partNamed(std::string_view name) {
  const auto* const found =
      std::ranges::find_if(kParts, [&](const Part& part) { return isCalled(part, name); });
  return found == kParts.end() ? nullptr : found;
}

std::string describeParts(const std::string& name) {
  if (const Part* part = partNamed(name)) return describe(*part);
  std::string text;
  for (const Part& part : kParts) text += describe(part);
  return text;
}

}  // namespace kerfbench::cortex_m_child
