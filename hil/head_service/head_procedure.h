// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/calibrate/head/correction_table.h"
#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/head/stated_spread.h"
#include "hil/calibrate/head/verified_table.h"
#include "hil/head_service/measured_sheet.h"
#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::head_service {

/// A sheet to be cut.
struct SheetOrder {
  calibrate::MarkJob job;
  int sheet{};  ///< Number of the sheet in this calibration, from 0.
  int round{};  ///< Iteration of the table; 0: the one that was at work before, if any.
  std::optional<calibrate::AimGrid> table;  ///< The controller's.
};
/// Cuts a sheet and measures it.
using CutAndMeasure = std::function<MeasuredSheet(const SheetOrder& order)>;

struct HeadPlan {
  std::vector<int> grids{3, 9, 17};  ///< Marks along each side of the grid, one iteration each.
  int verify{400};         ///< Marks that verify a table, at places of their own; see verifySheets().
  double limit_mm{0.010};  ///< Largest error of the beam anywhere in the field, U included.
  std::string date;        ///< ISO 8601 day of the jobs.
  std::uint64_t seed{1};   ///< Seed of the places that verify.
};

/// A head as marks of one sheet or several show it, and the table that follows.
struct FittedHead {
  calibrate::HeadFit fit;
  calibrate::CorrectionTableResult table;
};
/// @throws HeadCalibrationError.
FittedHead fitted(const std::vector<calibrate::HeadObservation>& observations, const HeadSetup& setup);

struct HeadIteration {
  int grid{};
  MeasuredSheet marks;                  ///< Marks cut with the table of the iteration before.
  SheetErrors before;                   ///< Errors of these marks.
  FittedHead head;                      ///< Head fitted to all marks so far but those that verify.
  std::vector<MeasuredSheet> verified;  ///< Sheets cut with head.table, to verify it.
  SheetErrors after;               ///< Errors of the verified sheets; of no marks where nothing was verified.
  calibrate::StatedSpread spread;  ///< Spread of the marks that verify, over what the fit alone states.
  calibrate::VerifiedTable table;  ///< What fit and marks that verify state of the table together.

  /// Largest error of the beam with head.table anywhere in the field, against the limit: decided as the
  /// checks of a run are, with U as guard band.
  [[nodiscard]] inspect::Check check(double limit_mm) const;
  /// The table is proven to be within the limit.
  [[nodiscard]] bool within(double limit_mm) const {
    return check(limit_mm).verdict == inspect::Verdict::kPass;
  }
  /// The same, and the marks that verify do not speak against what the fit states.
  [[nodiscard]] bool holds(double limit_mm) const { return within(limit_mm) && spread.holds(); }
};

/// Reason why this was the last iteration.
enum class HeadEnd { kGood, kNoBetter, kGridsUsed, kNotVerified };

struct HeadCalibration {
  std::vector<HeadIteration> iterations;
  std::size_t best{};  ///< The iteration whose table is the best.
  HeadEnd end{};
  /// Verdict of the best table. PASS is told as GOOD, or NOT VERIFIED where nothing was verified.
  inspect::Verdict verdict{inspect::Verdict::kInvalid};
  /// The table is within the limit, U included: as verified, or as the fit alone states.
  [[nodiscard]] bool good() const { return verdict == inspect::Verdict::kPass; }
  /// "GOOD", "NOT GOOD", "NOT PROVEN", "NOT VERIFIED"
  [[nodiscard]] std::string_view verdictName() const;
  [[nodiscard]] std::string endWords(const HeadPlan& plan) const;
};

/// Rounds of: cut a grid of marks with the table so far, fit the head by all grids, make a table, verify it
/// at random places that were not marked for the fit, on as many sheets as they need. Ends when the largest
/// error anywhere is proven to be within the limit and the errors are as what the fit states lets expect,
/// when the largest is no longer smaller than 0.9 of the least before, or after the last grid. `told` hears
/// of each iteration.
/// @throws HeadCalibrationError, HeadEvidenceError, ConfigError for places without room, and what `cut` does.
HeadCalibration calibrateHead(const HeadSetup& setup, const HeadPlan& plan, const CutAndMeasure& cut,
                              const std::function<void(const HeadIteration&)>& told);

/// Calibrates from one measured sheet, cut with the setup's table; nothing is verified, and the verdict is by
/// what the fit alone states. Of the plan it takes the limit.
HeadCalibration calibrateHeadOnce(const HeadSetup& setup, const HeadPlan& plan, const MeasuredSheet& sheet);

/// Job over the machine's field. @throws ConfigError for places that leave no room.
calibrate::MarkJob planSheet(const HeadSetup& setup, const HeadPlan& plan, const std::string& name,
                             const std::vector<Eigen::Vector2d>& places_mm, int first_number);

/// "scale of the X mirror: +0.00812 ± 0.00006", U with k = 2; or why the marks do not hold it.
std::string parameterWords(const calibrate::HeadParameterFinding& finding);

}  // namespace kerfbench::head_service
