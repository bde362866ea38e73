// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/calibrate/marks/mark_job.h"
#include "hil/head_service/print_page.h"

namespace kerfbench::head_service {

/// What a board says besides its marks.
struct BoardNotes {
  int sheet{1};                    ///< Number of the sheet in its calibration, from 1.
  std::vector<std::string> to_do;  ///< Lines of what is to be done with it.
};

/// Print of a board: the marks that hold its frame S, and around them, where no field mark is cut and no
/// camera looks for marks, what whoever lays it needs: the axes of S with the belt's direction, where its
/// origin is, rulers along both axes for the printer's scale, the machine's name, the job, its day and
/// number.
PrintPage boardPrint(const calibrate::MarkJob& job, const BoardNotes& notes);

/// Length of the rulers of such a print, mm: along x and along y.
Eigen::Vector2d rulersOf(const calibrate::MarkJob& job);

}  // namespace kerfbench::head_service
