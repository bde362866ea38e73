// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/calibrate/head/quick_check.h"
#include "hil/head_service/check_history.h"
#include "hil/head_service/measured_sheet.h"

namespace kerfbench::head_service {

/// What the page of a check says besides its result.
struct CheckFacts {
  std::string machine;
  std::string camera;
  std::string date;
  std::string command;
  std::string version;
  std::string calibration;  ///< Folder of the calibration that it was held against.
  std::string table;        ///< The controller's.
  double limit_mm{};        ///< Beyond it the beam is off too far.
  Eigen::AlignedBox2d field_W_mm;
};

/// One self-contained page: does the correction hold, what changed, and how zeros, gains and turn went over
/// the checks of `history` that were held against the same calibration (by date, the present one included).
std::string checkHtml(const calibrate::QuickCheckResult& result, const MeasuredSheet& sheet,
                      const std::vector<HeadCheckRecord>& history, const CheckFacts& facts);

/// Checks of the same machine that were held against the same calibration as `record`.
std::vector<HeadCheckRecord> comparable(const std::vector<HeadCheckRecord>& history,
                                        const HeadCheckRecord& record);

}  // namespace kerfbench::head_service
