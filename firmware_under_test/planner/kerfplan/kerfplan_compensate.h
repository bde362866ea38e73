// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Options of a job that concern the kerf.
void addKerfOptions(CLI::App& app, JobParameters& job);

/// `kerfplan compensate`: beam paths beside a drawing or a contour in space.
class CompensateCommand {
 public:
  explicit CompensateCommand(CLI::App& app);
  /// True if it was asked for, and is done.
  bool run() const;

 private:
  struct Options;
  CLI::App* sub_;
  std::shared_ptr<Options> options_;
};

/// `kerfplan prove-compensation`.
class ProveCommand {
 public:
  explicit ProveCommand(CLI::App& app);
  bool run() const;

 private:
  CLI::App* sub_;
  std::shared_ptr<std::string> folder_;
};

}  // namespace kerfbench::planner
