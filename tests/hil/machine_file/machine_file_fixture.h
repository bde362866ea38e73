// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "hil/base/yaml_reader.h"
#include "hil/machine_file/machine_file.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::machine_file {

/// Machine files of the project with a change, and the faults reported for them.
class MachineFileTest : public testing::Test {
 protected:
  static std::string text(const std::string& name) {
    return base::replaced(base::contentOf(base::fixture("machines/" + name)), "drivers: drivers.yaml",
                          "drivers: " + base::fixture("machines/drivers.yaml").string());
  }
  std::string faultsOf(const std::string& content) const { return faultsAt(temp_.write("m.yaml", content)); }
  [[nodiscard]] std::filesystem::path extending(const std::string& base, const std::string& lines) const {
    return temp_.write("m.yaml", "extends: " + base::fixture("machines/" + base).string() + "\n" + lines);
  }
  static std::string faultsAt(const std::filesystem::path& path) {
    try {
      readMachine(path);
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }
  const base::TempFolder temp_;
};

}  // namespace kerfbench::machine_file
