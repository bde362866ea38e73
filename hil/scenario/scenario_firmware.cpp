// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/scenario_sections.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/source/child_connection.h"

namespace kerfbench::scenario {
namespace {

constexpr std::size_t kLongestSetupLine = 255;
constexpr double kLargestReceiveBuffer = 65536;

/// Passes over the keys of a scenario with another source or dialog that this one extends.
void skipKeys(const base::YamlReader& firmware, const std::vector<const char*>& keys) {
  for (const char* key : keys) (void)firmware.has(key);
}

constexpr double kLatestStart_s = 60.0;

/// A job that is in the controller: how it starts, and when it is over.
void readStart(base::YamlReader& firmware, FirmwareChoice& result) {
  result.dialog = FirmwareChoice::Dialog::kNone;
  skipKeys(firmware, {"gcode", "setup", "ahead_bytes"});
  result.quiet_s = readQuiet_s(firmware);
  if (firmware.has("start_s"))
    result.start_s = firmware.number("start_s", {.min = 1e-3, .max = kLatestStart_s});
}

void readDialog(base::YamlReader& firmware, FirmwareChoice& result) {
  result.baud =
      static_cast<std::uint32_t>(firmware.integer("baud", {.min = 300, .max = 4e6, .fallback = 250e3}));
  const bool on_pins =
      result.onRealPins();  // Without a serial line nothing is spoken there, and no key says so.
  const std::string dialog = on_pins
                                 ? firmware.choice("dialog", {"kerfbench", "line-ok"}, "kerfbench")
                                 : firmware.choice("dialog", {"kerfbench", "line-ok", "none"}, "kerfbench");
  if (dialog == "none") return readStart(firmware, result);
  if (dialog == "line-ok") {
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
    firmware.fault("eeprom", "is for an emulated release (source: avr, mcs51, cortex_m, child)");
  result.eeprom_blank = firmware.text("eeprom") == "blank";
  if (!result.eeprom_blank) result.eeprom = fileOf(firmware, "eeprom");
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

/// A program, or the address of one that runs elsewhere.
std::filesystem::path childOf(base::YamlReader& firmware, const ImagePath& images) {
  const std::filesystem::path named = firmware.text("child", "");
  return source::isConnection(named) ? named : fileOf(firmware, "child", images.firmware_dir);
}

FirmwareChoice readFirmwareOnPins(base::YamlReader& firmware, const ImagePath& images) {
  FirmwareChoice result;
  result.source = FirmwareChoice::Source::kGpio;
  result.gpio = readGpioChoice(firmware);
  if (result.gpio.uart.empty()) {
    result.dialog = FirmwareChoice::Dialog::kNone;
    skipKeys(firmware, {"image", "baud", "dialog", "gcode", "setup", "ahead_bytes", "start_s"});
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
            "start_s", "chip", "stamp_err_us", "out_chip", "max_lag_us", "uart_wait_s", "uart_delay_ms"});
  for (const char* key : {"outputs", "uart"}) {
    if (firmware.has(key))
      firmware.fault(key, "is for source: gpio; an analyser drives nothing and talks to no controller");
  }
  return result;
}

}  // namespace

const Emulator* FirmwareChoice::emulator() const {
  const auto found = std::ranges::find(kEmulators, source, &Emulator::source);
  return found == kEmulators.end() ? nullptr : &*found;
}

std::filesystem::path FirmwareChoice::childIn(const std::filesystem::path& bin_dir) const {
  if (const Emulator* own = emulator()) return bin_dir / own->program;
  return source == Source::kNative ? image : child;
}

FirmwareChoice readFirmware(base::YamlReader firmware, const ImagePath& images) {
  const std::string source =
      firmware.choice("source", {"avr", "mcs51", "cortex_m", "native", "child", "gpio", "analyser"});
  if (source == "gpio") return readFirmwareOnPins(firmware, images);
  if (source == "analyser") return readFirmwareOnAnalyser(firmware);
  FirmwareChoice result;
  const auto emulator = std::ranges::find(kEmulators, source, &Emulator::key);
  const Emulator& usual = emulator == kEmulators.end() ? kEmulators.front() : *emulator;
  result.source = source == "native"  ? FirmwareChoice::Source::kNative
                  : source == "child" ? FirmwareChoice::Source::kChild
                                      : usual.source;
  result.image = imageOf(firmware, images);
  if (result.source == FirmwareChoice::Source::kChild) result.child = childOf(firmware, images);
  result.mcu = firmware.text("mcu", std::string(usual.mcu));
  result.clock_hz = static_cast<std::uint64_t>(firmware.integer(
      "clock_hz", {.min = 1e5, .max = 1e9, .fallback = static_cast<double>(usual.clock_hz)}));
  readEeprom(firmware, result);
  readDialog(firmware, result);
  return result;
}

}  // namespace kerfbench::scenario
