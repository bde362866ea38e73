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
  explicit Faults(const scenario::Scenario& scenario) : scenario_(scenario) {}

  void add(const std::filesystem::path& file, const std::string& section, std::string_view key,
           const std::string& what) {
    // A scenario in an editor need not be saved as it is.
    auto reader = file == scenario_.path ? base::YamlReader::openText(file, scenario_.text)
                                         : base::YamlReader::openFile(file);
    const base::YamlReader opened =
        reader.section(section);  // Places are known of sections that were opened.
    const std::string whole = fmt::format("{}.{}", section, key);
    text_ += fmt::format("{}{}: {}: {}", text_.empty() ? "" : "\n", reader.placeOf(whole), whole, what);
  }
  void refuse() const {
    if (!text_.empty()) throw base::ConfigError(text_);
  }

 private:
  const scenario::Scenario& scenario_;
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
  auto file = base::YamlReader::openFile(test_case.scenario.machine);
  base::YamlReader pins = file.section("pins");
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const auto pin = test_case.machine.signals.pin(signal);
    if (!pin) continue;
    // The name as it was written: P1.0 is no name of a pin of an AVR, and PB0 none of an 8051.
    const std::string name = pins.text(signalName(signal));
    if (controller.hasPin(*pin) && controller.nameOf(*pin) == name) continue;
    faults.add(test_case.scenario.machine, "pins", signalName(signal),
               fmt::format("an {} has no {}: its ports are {}, with bits 0 to {}",
                           test_case.scenario.firmware.mcu, name, ports, controller.port_bits - 1));
  }
}

}  // namespace

void refuseUnfitController(const scenario::Case& test_case, const std::filesystem::path& bin_dir) {
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  if (firmware.emulator() == nullptr) return;
  const std::filesystem::path child = firmware.childIn(bin_dir);
  if (!std::filesystem::exists(child)) return;  // A run says so.
  const std::vector<Controller> all = source::emulatedControllers(child, firmware.mcu);
  const auto controller =
      std::ranges::find_if(all, [&](const Controller& c) { return c.isCalled(firmware.mcu); });
  Faults faults(test_case.scenario);
  if (controller == all.end()) {
    faults.add(test_case.scenario.path, "firmware", "mcu", unknown(firmware.mcu, all));
    faults.refuse();
  }
  holdPins(test_case, *controller, faults);
  // The AVR child talks by UART 0 alone, the others by the first that the controller has.
  const bool by_uart_0 = firmware.source == scenario::FirmwareChoice::Source::kAvr;
  const bool can_talk =
      by_uart_0 ? controller->uarts.find('0') != std::string::npos : !controller->uarts.empty();
  if (firmware.dialog != scenario::FirmwareChoice::Dialog::kNone && !can_talk)
    faults.add(test_case.scenario.path, "firmware", "mcu",
               fmt::format("the emulator has no UART{} of an {}, by which the bench talks to it",
                           by_uart_0 ? " 0" : "", firmware.mcu));
  faults.refuse();
}

}  // namespace kerfbench::run
