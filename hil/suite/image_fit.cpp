// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/image_fit.h"

#include <array>
#include <charconv>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "hil/base/file_content.h"
#include "hil/run/release.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;
using Source = scenario::FirmwareChoice::Source;

/// The first two bytes of the program memory, of an Intel HEX file whose first record has them.
std::optional<std::array<unsigned, 2>> resetBytes(const fs::path& image) {
  std::istringstream lines(base::fileContent(image).value_or(""));
  for (std::string line; std::getline(lines, line);) {
    // ":LLAAAATTDD…": length, address, type 0 for data.
    if (line.size() < 13 || line[0] != ':' || line.substr(3, 6) != "000000") continue;
    std::array<unsigned, 2> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::string digits = line.substr(9 + 2 * i, 2);
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + 2, bytes.at(i), 16);
      if (error != std::errc{} || end != digits.data() + 2) return std::nullopt;
    }
    return bytes;
  }
  return std::nullopt;
}

/// AVR: JMP is 1001 010k kkkk 110k, RJMP 1100 kkkk kkkk kkkk, low byte first (Microchip DS40002198).
bool beginsAsAvr(const std::array<unsigned, 2>& reset) {
  const bool is_jmp = (reset[1] & 0xFEU) == 0x94U && (reset[0] & 0x0EU) == 0x0CU;
  return is_jmp || (reset[1] & 0xF0U) == 0xC0U;
}

/// 8051: LJMP is 02 (Intel 1994).
bool beginsAs8051(const std::array<unsigned, 2>& reset) { return reset[0] == 0x02U; }

}  // namespace

std::string whyImageDoesNotFit(const scenario::FirmwareChoice& firmware, const fs::path& bin_dir) {
  if (firmware.source == Source::kAnalyser)
    return "its pins are those of a real controller behind an analyser: the bench gives it no image";
  if (firmware.onRealPins() || firmware.source == Source::kChild) return {};
  if (const auto reset = resetBytes(firmware.image)) {
    if (firmware.source == Source::kAvr && beginsAs8051(*reset) && !beginsAsAvr(*reset))
      return "its controller is an AVR, and the image begins with a jump of an 8051";
    if (firmware.source == Source::kMcs51 && beginsAsAvr(*reset) && !beginsAs8051(*reset))
      return "its controller is an 8051, and the image begins with a jump of an AVR";
  }
  try {
    (void)run::openRelease(firmware, bin_dir);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return {};
}

}  // namespace kerfbench::suite
