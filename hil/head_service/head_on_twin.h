// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "hil/head_service/head_procedure.h"
#include "hil/head_service/sheet_on_twin.h"

namespace kerfbench::head_service {

/// Cuts the sheets of one calibration on the twin, each in a folder of `results` that has its job's name; a
/// table is there, as correction-ROUND.csv, before it is used. For calibrateHead(). `setup` must outlive it.
class HeadOnTwin {
 public:
  HeadOnTwin(const HeadSetup& setup, TwinBench bench, std::filesystem::path results);

  MeasuredSheet operator()(const SheetOrder& order) const;

  std::function<void(const std::string& sheet, double now_s, const std::string& what)> progress;
  /// Callback for sheets that were measured before.
  std::function<void(const std::string& sheet)> was_there;

 private:
  const HeadSetup* setup_;
  TwinBench bench_;
  std::filesystem::path results_;
};

}  // namespace kerfbench::head_service
