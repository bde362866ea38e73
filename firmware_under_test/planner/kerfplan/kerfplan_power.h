// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::planner {

struct PowerOptions {
  std::string material, laser;  ///< Files, or numbers or names in the library; both or none.
  std::string library;          ///< Folder of numbered materials and lasers.
  double depth_mm{};            ///< Depth of cuts; 0: not given.
  double half_depth_mm{};       ///< Depth of half-cuts; 0: not given.
  double spot_diameter_mm{0.2};
};

void addPowerOptions(CLI::App& app, PowerOptions& options);

/// Power model of the options; null if none was given. @throws PowerError that names all that is wrong.
std::shared_ptr<const PowerModel> powerModelOf(const PowerOptions& options);

/// Command `kerfplan power`: the chain from speed to control signal as a table.
class PowerCommand {
 public:
  explicit PowerCommand(CLI::App& app);
  /// Runs the command; true if it was given.
  bool run() const;

 private:
  struct Options;
  CLI::App* sub_;
  std::shared_ptr<Options> options_;
};

}  // namespace kerfbench::planner
