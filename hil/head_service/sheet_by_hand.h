// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/head_service/head_procedure.h"
#include "hil/head_service/measured_sheet.h"
#include "hil/head_service/sheet_on_twin.h"

namespace kerfbench::head_service {

/// A sheet whose pictures are not there yet; the message says what somebody is to do, a line each.
class SheetWanted : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Sheets that people cut on a machine and photograph, one folder each, in place of the twin: a
/// CutAndMeasure. What is missing is written and waited for by ending; the next run goes on from there.
///
///     marks.yaml, marks.dxf   the job and its drawing
///     table.csv               what the controller corrects with; not there: nothing
///     print.svg               the printed marks of the board
///     job.gcode, program.txt  the job planned for the controller; its program as kerfplan writes it
///     run.yaml, machine.yaml  the same as a scenario
///     NEXT.txt                what is to be done
///     pictures/               to be put there, with tiles.yaml (hil/camera/tile_folder.h)
///     measured.yaml           what they showed
class SheetByHand {
 public:
  /// @param bench its bin_dir, firmware and threads are used. @param command to be run again, for people.
  SheetByHand(const HeadSetup& setup, TwinBench bench, std::filesystem::path results, std::string command)
      : setup_(setup), bench_(std::move(bench)), results_(std::move(results)), command_(std::move(command)) {}

  /// @throws SheetWanted until there are pictures; HeadEvidenceError, ConfigError, planner::PlanError.
  MeasuredSheet operator()(const SheetOrder& order) const;

 private:
  [[nodiscard]] std::string digestOf(const calibrate::MarkJob& job,
                                     const std::optional<calibrate::AimGrid>& table,
                                     const std::filesystem::path& pictures) const;
  void writeFiles(const SheetRequest& request) const;
  [[nodiscard]] std::string instructions(const SheetRequest& request) const;

  const HeadSetup& setup_;
  TwinBench bench_;
  std::filesystem::path results_;
  std::string command_;
};

/// The printed marks of a job's board, in mm, to be printed at 100 %.
std::string printSvg(const calibrate::MarkJob& job);

/// Release as a scenario names it: an AVR image (.hex, ATmega2560) or a native one; empty stays empty.
std::string firmwareOf(const std::filesystem::path& name);

}  // namespace kerfbench::head_service
