// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/scenario_sections.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace kerfbench::scenario {
namespace {

constexpr std::size_t kLongestSetupLine = 255;
constexpr double kLargestReceiveBuffer = 65536;

void readDialog(base::YamlReader& firmware, FirmwareChoice& result) {
  result.baud =
      static_cast<std::uint32_t>(firmware.integer("baud", {.min = 300, .max = 4e6, .fallback = 250e3}));
  if (firmware.choice("dialog", {"kerfbench", "line-ok"}, "kerfbench") == "line-ok") {
    result.dialog = FirmwareChoice::Dialog::kLineOk;
    result.gcode = fileOf(firmware, "gcode");
    result.setup = firmware.texts("setup");
    for (const std::string& line : result.setup) {
      const bool is_line = std::ranges::all_of(line, [](unsigned char c) { return c >= ' '; });
      if (!is_line || line.size() > kLongestSetupLine)
        firmware.fault("setup",
                       fmt::format("a line has up to {} characters, none of them a control character",
                                   kLongestSetupLine));
    }
    result.ahead_bytes = static_cast<std::size_t>(
        firmware.integer("ahead_bytes", {.min = 0, .max = kLargestReceiveBuffer, .fallback = 0}));
  }
}

void readEeprom(base::YamlReader& firmware, FirmwareChoice& result) {
  if (!firmware.has("eeprom")) return;
  if (result.source == FirmwareChoice::Source::kNative)
    firmware.fault("eeprom", "is for an emulated release (source: avr, child)");
  result.eeprom_blank = firmware.text("eeprom") == "blank";
  if (!result.eeprom_blank) result.eeprom = fileOf(firmware, "eeprom");
}

/// Passes over the keys of a scenario with another source that this one extends.
void skipKeys(const base::YamlReader& firmware, const std::vector<const char*>& keys) {
  for (const char* key : keys) (void)firmware.has(key);
}

std::filesystem::path imageOf(base::YamlReader& firmware, const ImagePath& images) {
  if (images.image.empty()) return fileOf(firmware, "image", images.firmware_dir);
  skipKeys(firmware, {"image"});
  const std::filesystem::path image = std::filesystem::absolute(images.image).lexically_normal();
  if (!std::filesystem::is_regular_file(image))
    firmware.fault("image", fmt::format("no such file '{}' (--image)", images.image.string()));
  firmware.names(image);
  return image;
}

FirmwareChoice readFirmwareOnPins(base::YamlReader& firmware, const ImagePath& images) {
  FirmwareChoice result;
  result.source = FirmwareChoice::Source::kGpio;
  result.gpio = readGpioChoice(firmware);
  if (result.gpio.uart.empty()) {
    result.dialog = FirmwareChoice::Dialog::kNone;
    skipKeys(firmware, {"image", "baud", "dialog", "gcode", "setup", "ahead_bytes"});
  } else {
    if (firmware.has("image") || !images.image.empty()) result.image = imageOf(firmware, images);
    readDialog(firmware, result);
  }
  skipKeys(firmware, {"child", "mcu", "clock_hz", "eeprom"});
  return result;
}

FirmwareChoice readFirmwareOnAnalyser(base::YamlReader& firmware) {
  FirmwareChoice result;
  result.source = FirmwareChoice::Source::kAnalyser;
  result.dialog = FirmwareChoice::Dialog::kNone;
  result.analyser = readAnalyserChoice(firmware);
  skipKeys(firmware,
           {"image", "child", "mcu", "clock_hz", "eeprom", "baud", "dialog", "gcode", "setup", "ahead_bytes",
            "chip", "stamp_err_us", "out_chip", "max_lag_us", "uart_wait_s", "uart_delay_ms"});
  for (const char* key : {"outputs", "uart"}) {
    if (firmware.has(key))
      firmware.fault(key, "is for source: gpio; an analyser drives nothing and talks to no controller");
  }
  return result;
}

}  // namespace

FirmwareChoice readFirmware(base::YamlReader firmware, const ImagePath& images) {
  const std::string source = firmware.choice("source", {"avr", "native", "child", "gpio", "analyser"});
  if (source == "gpio") return readFirmwareOnPins(firmware, images);
  if (source == "analyser") return readFirmwareOnAnalyser(firmware);
  FirmwareChoice result;
  result.source = source == "native"  ? FirmwareChoice::Source::kNative
                  : source == "child" ? FirmwareChoice::Source::kChild
                                      : FirmwareChoice::Source::kAvr;
  result.image = imageOf(firmware, images);
  if (result.source == FirmwareChoice::Source::kChild)
    result.child = fileOf(firmware, "child", images.firmware_dir);
  result.mcu = firmware.text("mcu", result.mcu);
  result.clock_hz =
      static_cast<std::uint64_t>(firmware.integer("clock_hz", {.min = 1e5, .max = 1e9, .fallback = 16e6}));
  readEeprom(firmware, result);
  readDialog(firmware, result);
  return result;
}

}  // namespace kerfbench::scenario
