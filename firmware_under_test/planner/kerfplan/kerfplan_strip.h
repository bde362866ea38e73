// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Commands `kerfplan throughput` and `kerfplan strip-path`, for a strip that is cut to length.
class StripCommands {
 public:
  /// `add_options` adds the options that fill `machine` and `job`, which must outlive this.
  StripCommands(CLI::App& app, const MachineParameters& machine, const JobParameters& job,
                const std::function<void(CLI::App&)>& add_options);
  /// Runs the command that was given; false if none was. @throws PlanError.
  [[nodiscard]] bool run() const;

 private:
  struct Options;
  const MachineParameters& machine_;
  const JobParameters& job_;
  CLI::App* throughput_;
  CLI::App* path_;
  std::shared_ptr<Options> options_;
};

}  // namespace kerfbench::planner
