// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Adds the options of a job that concern the kerf.
void addKerfOptions(CLI::App& app, JobParameters& job);

/// Command `kerfplan compensate`: beam paths along a drawing or a contour in space.
class CompensateCommand {
 public:
  explicit CompensateCommand(CLI::App& app);
  /// Runs the command; true if it was given.
  bool run() const;

 private:
  struct Options;
  CLI::App* sub_;
  std::shared_ptr<Options> options_;
};

/// Command `kerfplan prove-compensation`.
class ProveCommand {
 public:
  explicit ProveCommand(CLI::App& app);
  bool run() const;

 private:
  CLI::App* sub_;
  std::shared_ptr<std::string> folder_;
};

}  // namespace kerfbench::planner
