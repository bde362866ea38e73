// SPDX-License-Identifier: Apache-2.0
#include "hil/run/controller_fit.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/base/yaml_reader.h"
#include "hil/source/controllers.h"

namespace kerfbench::run {
namespace {

using source::Controller;

/// One line for each fault, with the place of a key.
class Faults {
 public:
  void add(const std::filesystem::path& file, const std::string& section, std::string_view key,
           const std::string& what) {
    auto reader = base::YamlReader::openFile(file);
    const base::YamlReader opened =
        reader.section(section);  // Places are known of sections that were opened.
    const std::string whole = fmt::format("{}.{}", section, key);
    text_ += fmt::format("{}{}: {}: {}", text_.empty() ? "" : "\n", reader.placeOf(whole), whole, what);
  }
  void refuse() const {
    if (!text_.empty()) throw base::ConfigError(text_);
  }

 private:
  std::string text_;
};

std::string unknown(const std::string& mcu, const std::vector<Controller>& all) {
  std::string nearest;
  for (const std::string& name : source::namesLike(mcu, all)) nearest += (nearest.empty() ? "" : ", ") + name;
  return fmt::format("the emulator has no '{}'; most like it: {}", mcu, nearest);
}

void holdPins(const scenario::Case& test_case, const Controller& controller, Faults& faults) {
  std::string ports;
  for (const char port : controller.ports) ports += fmt::format("{}P{}", ports.empty() ? "" : ", ", port);
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const auto pin = test_case.machine.signals.pin(signal);
    if (!pin || controller.hasPin(*pin)) continue;
    faults.add(test_case.scenario.machine, "pins", signalName(signal),
               fmt::format("an {} has no {}: its ports are {}, with bits 0 to 7",
                           test_case.scenario.firmware.mcu, source::pinName(*pin), ports));
  }
}

}  // namespace

void refuseUnfitController(const scenario::Case& test_case, const std::filesystem::path& bin_dir) {
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  if (firmware.source != scenario::FirmwareChoice::Source::kAvr) return;
  const std::filesystem::path child = bin_dir / "kerfbench-avr";
  if (!std::filesystem::exists(child)) return;  // A run says so.
  const std::vector<Controller> all = source::emulatedControllers(child, firmware.mcu);
  const auto controller =
      std::ranges::find_if(all, [&](const Controller& c) { return c.isCalled(firmware.mcu); });
  Faults faults;
  if (controller == all.end()) {
    faults.add(test_case.scenario.path, "firmware", "mcu", unknown(firmware.mcu, all));
    faults.refuse();
  }
  holdPins(test_case, *controller, faults);
  if (firmware.dialog != scenario::FirmwareChoice::Dialog::kNone &&
      controller->uarts.find('0') == std::string::npos)
    faults.add(
        test_case.scenario.path, "firmware", "mcu",
        fmt::format("the emulator has no UART 0 of an {}, by which the bench talks to it", firmware.mcu));
  faults.refuse();
}

}  // namespace kerfbench::run
