// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "hil/calibrate/tables/aim_grid.h"
#include "hil/head_service/head_procedure.h"
#include "hil/head_service/measured_sheet.h"
#include "hil/head_service/service_steps.h"
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
///     print.svg, print.pdf    the print of the board (board_print.h)
///     job.gcode, program.txt  the job planned for the controller; its program as kerfplan writes it
///     run.yaml, machine.yaml  the same as a scenario
///     NEXT.txt                what is to be done
///     pictures/               to be put there, beside tiles.yaml (hil/camera/tile_folder.h), which is a
///                             template of the pictures that are expected (frame_plan.h); or one scan
///                             (scanned_sheet.h)
///     measured.yaml           what they showed
class SheetByHand {
 public:
  /// @param bench its bin_dir, firmware and threads are used. @param command to be run again, for people.
  /// @param steps hears of each sheet, and is written when one is wanted or refused; must outlive this.
  SheetByHand(const HeadSetup& setup, TwinBench bench, std::filesystem::path results, std::string command,
              ServiceSteps& steps)
      : setup_(setup),
        bench_(std::move(bench)),
        results_(std::move(results)),
        command_(std::move(command)),
        steps_(&steps) {}

  /// @throws SheetWanted until there are all pictures; HeadEvidenceError, ConfigError, planner::PlanError.
  MeasuredSheet operator()(const SheetOrder& order) const;

 private:
  [[nodiscard]] std::string digestOf(const calibrate::MarkJob& job,
                                     const std::optional<calibrate::AimGrid>& table,
                                     const std::filesystem::path& pictures) const;
  [[nodiscard]] MeasuredSheet measured(const SheetOrder& order, const SheetRequest& request) const;
  /// Writes what somebody needs to cut the sheet, and says it. @throws SheetWanted.
  [[noreturn]] void want(const SheetOrder& order, SheetRequest request,
                         const std::vector<std::string>& missing) const;
  void writeFiles(const SheetOrder& order, const SheetRequest& request) const;

  const HeadSetup& setup_;
  TwinBench bench_;
  std::filesystem::path results_;
  std::string command_;
  ServiceSteps* steps_;
};

/// Release as a scenario names it: an AVR image (.hex, ATmega2560) or a native one; empty stays empty.
std::string firmwareOf(const std::filesystem::path& name);

}  // namespace kerfbench::head_service
