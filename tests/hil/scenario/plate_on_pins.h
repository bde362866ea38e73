// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "hil/base/yaml_reader.h"
#include "hil/scenario/case.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::scenario {

/// Scenario of a plate, moved to real pins.
class PlateOnPins : public testing::Test {
 protected:
  void SetUp() override { (void)temp_.write("linecutter-avr.hex", ":00000001FF\n"); }
  /// Scenario with these lines, which begin in its line 3.
  std::filesystem::path scenario(const std::string& lines) const {
    return temp_.write("s.yaml", "extends: " + base::fixture("scenarios/line-ok/plate.yaml").string() +
                                     "\nname: on-pins\n" + lines);
  }
  Case plate(const std::string& lines) const { return readCase(scenario(lines), temp_.path()); }
  std::string faultsIn(const std::string& lines) const {
    try {
      (void)plate(lines);
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }
  const base::TempFolder temp_;
};

}  // namespace kerfbench::scenario
