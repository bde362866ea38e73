// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/turned_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>

#include "hil/calibrate/marks/field_marks.h"
#include "twin/base/statistics.h"

namespace kerfbench::head_service {
namespace {

using Eigen::Isometry2d;
using Eigen::Rotation2Dd;
using Eigen::Translation2d;

/// The turn about the middle of the printed marks, in S.
Isometry2d turnOf(const calibrate::MarkJob& job, double turn_deg) {
  Eigen::AlignedBox2d print;
  for (const RegistrationMark& mark : job.print) print.extend(mark.p_SM_mm);
  return Translation2d(print.center()) * Rotation2Dd(turn_deg * std::numbers::pi / 180.0) *
         Translation2d(-print.center());
}

/// The printed marks of a square board fit turned by a quarter too, but for the odd ones: the cut marks
/// decide.
void refuseOtherTurn(const calibrate::MarkedField& field, const calibrate::MarkJob& job,
                     const Isometry2d& X_US, const HeadSetup& setup, const std::string& name) {
  std::vector<double> off_mm;
  for (const calibrate::MarkPoint& point : field.points)
    off_mm.push_back((X_US.inverse() * point.cut.p_S_mm - job.wanted_S_mm(point.wanted)).norm());
  const double median_mm = upperMedianIn(off_mm);
  if (median_mm <= setup.off_mm) return;
  throw HeadEvidenceError(fmt::format(
      "job {}, {}: the marks lie {:.1f} mm from where they should, in the median: the sheet is not turned so",
      job.name, name, median_mm));
}

}  // namespace

TurnedView lookAt(camera::TileSource& tiles, std::size_t pictures, const calibrate::MarkJob& job,
                  double turn_deg, const HeadSetup& setup, int threads) {
  // The sheet is looked for where it was before it was turned: as a sheet whose print is turned.
  const Isometry2d X_US = turnOf(job, turn_deg);
  std::vector<RegistrationMark> print = job.print;
  for (RegistrationMark& mark : print) mark.p_SM_mm = X_US * mark.p_SM_mm;
  const calibrate::FieldSearchOptions search{.size_mm = job.size_mm,
                                             .open_gray = setup.open_gray,
                                             .beam_radius_mm = setup.beam_radius_mm,
                                             .board_thickness_mm = kMarkBoard_mm,
                                             .table_sigma_mm = setup.table_sigma_mm,
                                             .threads = threads};
  const calibrate::FieldPictures found = calibrate::findFieldMarks(tiles, setup.camera, print, search);
  const calibrate::MarkedField field = calibrate::matchField(job, found);
  const std::string name = fmt::format("turned by {:g}°", turn_deg);
  if (!field.problems.empty())
    throw HeadEvidenceError(fmt::format("job {}, {}: {}", job.name, name, fmt::join(field.problems, "\n  ")));
  refuseOtherTurn(field, job, X_US, setup, name);

  TurnedView view{{name, {}}, Isometry2d::Identity(), pictures, {}};
  const Isometry2d X_TU = Translation2d(found.pose.p_TS_mm) * Rotation2Dd(found.pose.angle_rad);
  view.X_TS = X_TU * X_US;
  for (const calibrate::MarkPoint& point : field.points) {
    const Eigen::Matrix2d C = X_TU.rotation() * point.cut.covariance * X_TU.rotation().transpose();
    view.marks.marks.push_back({point.wanted.number, X_TU * point.cut.p_S_mm, 0.5 * (C + C.transpose())});
  }
  if (!field.missing.empty())
    view.remarks.push_back(fmt::format("{}: {} marks not found", name, field.missing.size()));
  return view;
}

}  // namespace kerfbench::head_service
