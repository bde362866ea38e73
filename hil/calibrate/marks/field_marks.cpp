// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/field_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hil/base/parallel.h"
#include "hil/calibrate/marks/mark_centre.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/calibrate/marks/mark_reader.h"
#include "hil/calibrate/marks/mark_strokes.h"
#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_pictures.h"
#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/scan/kerf_unit.h"
#include "hil/vision/scan/sight_pairs.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kStationPitch_mm = 0.2;  // Windows of calipers then touch, but share no pixel.
constexpr double kOfMark = 1.35;  // Strokes so near to a centre, in halves of a size, are of that mark.

Matrix2d matrixOf(const MarkTurn& turn) {
  Matrix2d mirror = Matrix2d::Identity();
  if (turn.mirrored) mirror(0, 0) = -1.0;
  Matrix2d quarter;
  quarter << 0.0, -1.0, 1.0, 0.0;
  for (int q = 0; q < turn.quarters; ++q) mirror = quarter * mirror;
  return mirror;
}

MarkTurn nearestTurn(const Matrix2d& as_cut) {
  const auto turns = markTurns();
  return *std::ranges::min_element(
      turns, {}, [&](const MarkTurn& turn) { return (as_cut - matrixOf(turn)).squaredNorm(); });
}

void sortByPlace(std::vector<DamagedMark>& damaged) {
  std::ranges::sort(damaged, [](const DamagedMark& a, const DamagedMark& b) {
    return a.p_S_mm.x() != b.p_S_mm.x() ? a.p_S_mm.x() < b.p_S_mm.x() : a.p_S_mm.y() < b.p_S_mm.y();
  });
}

/// The search in one unit whose place is known.
class FieldSearch {
 public:
  FieldSearch(const vision::CameraCalibration& calibration, const FieldSearchOptions& options,
              const vision::KerfScanOptions& scan, const vision::UnitPictures& pictures,
              const vision::TileIndex& index, const vision::PlaneMotion& X_TS)
      : calibration_(calibration),
        options_(options),
        scan_(scan),
        pictures_(pictures),
        index_(index),
        X_TS_(X_TS) {}

  void run(FieldPictures& out) {
    const std::vector<Stroke> strokes = strokesOfAll();
    std::vector<Stroke> arms;
    std::ranges::copy_if(strokes, std::back_inserter(arms),
                         [&](const Stroke& stroke) { return isArm(stroke, options_.size_mm); });
    const Crosses crosses = assembleCrosses(arms, options_.size_mm);
    for (const Vector2d& p_T_mm : crosses.broken_T_mm)
      out.damaged.push_back({X_TS_.inverse(p_T_mm), "lacks an arm"});
    out.strays = countStrays(strokes, crosses);
    read(crosses, out);
    measure(out);
    sortByPlace(out.damaged);
    std::ranges::sort(out.marks, [](const FieldMark& a, const FieldMark& b) {
      if (a.number != b.number) return a.number < b.number;
      return a.p_S_mm.x() != b.p_S_mm.x() ? a.p_S_mm.x() < b.p_S_mm.x() : a.p_S_mm.y() < b.p_S_mm.y();
    });
  }

 private:
  struct Read {
    Cross cross;
    MarkReading reading;
  };

  [[nodiscard]] std::vector<Stroke> strokesOfAll() const {
    std::vector<std::vector<Stroke>> of_tile(pictures_.views.size());
    base::forEachIndex(of_tile.size(), options_.threads, [&](std::size_t t) {
      of_tile[t] = findStrokes(pictures_.views[t], calibration_, options_.open_gray);
    });
    std::vector<Stroke> all;
    for (const auto& some : of_tile) all.insert(all.end(), some.begin(), some.end());
    return uniqueStrokes(all);
  }

  [[nodiscard]] int countStrays(const std::vector<Stroke>& strokes, const Crosses& crosses) const {
    const double reach_mm = kOfMark * 0.5 * options_.size_mm;
    const auto near = [&](const Vector2d& p_T_mm) {
      const auto of_mark = [&](const Vector2d& centre) { return (centre - p_T_mm).norm() < reach_mm; };
      return std::ranges::any_of(crosses.whole, of_mark, &Cross::p_T_mm) ||
             std::ranges::any_of(crosses.broken_T_mm, of_mark);
    };
    return static_cast<int>(
        std::ranges::count_if(strokes, [&](const Stroke& stroke) { return !near(stroke.p_T_mm); }));
  }

  void read(const Crosses& crosses, FieldPictures& out) {
    for (const Cross& cross : crosses.whole) {
      const auto answer = readTicks(cross, index_, calibration_, options_.open_gray);
      if (const auto* reason = std::get_if<std::string>(&answer)) {
        out.damaged.push_back({X_TS_.inverse(cross.p_T_mm), *reason});
      } else {
        read_.push_back({cross, std::get<MarkReading>(answer)});
      }
    }
  }

  void measure(FieldPictures& out) {
    dieline::Dieline arms;
    std::vector<std::array<ArmLine, 2>> lines;
    for (const Read& mark : read_) {
      lines.push_back(armLines(mark.cross, X_TS_));
      for (dieline::Curve& curve : armCurves(lines.back()))
        arms.entities.push_back(
            {static_cast<int>(arms.entities.size()), std::move(curve), dieline::Process::kCut, "", ""});
    }
    const vision::KerfPlan plan = vision::planKerf(arms, scan_);
    vision::KerfScan kerfs;
    depths_ =
        vision::sightDepths(vision::sightPairs(plan, {pictures_.views, index_, X_TS_, calibration_, scan_}),
                            pictures_.views.size(), scan_.board_thickness_mm, scan_.table_sigma_mm)
            .depths;
    vision::UnitScan(calibration_, plan, scan_, {pictures_.views, index_, 0, X_TS_, pictures_.blur, depths_})
        .cuts(kerfs);
    for (std::size_t m = 0; m < read_.size(); ++m) {
      const auto arm = [&](std::size_t k) { return &kerfs.entities.at(4 * m + k); };
      const auto answer = centreOf(lines[m], {arm(0), arm(1), arm(2), arm(3)});
      if (const auto* reason = std::get_if<std::string>(&answer)) {
        out.damaged.push_back({X_TS_.inverse(read_[m].cross.p_T_mm), *reason});
      } else {
        out.marks.push_back(markOf(read_[m], std::get<MarkCentre>(answer)));
      }
    }
  }

  [[nodiscard]] FieldMark markOf(const Read& read, const MarkCentre& centre) const {
    FieldMark mark;
    mark.number = read.reading.number;
    mark.p_S_mm = centre.p_S_mm;
    mark.covariance = centre.covariance;
    mark.kerf_width_mm = centre.width_mm;
    const Matrix2d R_SM = Eigen::Rotation2Dd(kMarkTurn_rad).toRotationMatrix();
    const Matrix2d axes_S = X_TS_.rotation().transpose() * read.cross.axes_mm / (0.5 * options_.size_mm);
    mark.as_cut = axes_S * matrixOf(read.reading.turn) * R_SM.transpose();
    mark.turn = nearestTurn(mark.as_cut);
    const Vector2d p_T_mm = X_TS_ * centre.p_S_mm;
    if (const vision::TileView* view = index_.best(p_T_mm, 0.0); view != nullptr) {
      mark.p_V_mm = p_T_mm - view->tile.p_TV_mm;
      const Vector2d by_depth_mm =
          depths_.front().sigma_mm * (X_TS_.rotation().transpose() * calibration_.sightSlope(mark.p_V_mm));
      mark.covariance += by_depth_mm * by_depth_mm.transpose();
      mark.covariance += scan_.table_sigma_mm * scan_.table_sigma_mm * Matrix2d::Identity();
    }
    return mark;
  }

  const vision::CameraCalibration& calibration_;
  const FieldSearchOptions& options_;
  const vision::KerfScanOptions& scan_;
  const vision::UnitPictures& pictures_;
  const vision::TileIndex& index_;
  vision::PlaneMotion X_TS_;
  vision::SightDepths depths_{};
  std::vector<Read> read_;
};

void checkOptions(const FieldSearchOptions& options) {
  if (!(options.size_mm > 0.0) || !(options.open_gray > 0.0) || !(options.beam_radius_mm >= 0.0))
    throw std::invalid_argument("field marks: size_mm and open_gray must be > 0, beam_radius_mm >= 0");
}

FieldPictures searchSheet(camera::TileSource& tiles, const vision::CameraCalibration& calibration,
                          const std::vector<RegistrationMark>& print, const FieldSearchOptions& options) {
  vision::KerfScanOptions scan;
  scan.station_pitch_mm = kStationPitch_mm;
  scan.patches = 0;
  scan.beam_radius_mm = options.beam_radius_mm;
  scan.open_gray = options.open_gray;
  scan.board_thickness_mm = options.board_thickness_mm;
  scan.table_sigma_mm = options.table_sigma_mm;
  scan.threads = options.threads;
  PrintLayout layout;
  layout.pitch_mm = 1.0;  // There is one unit alone: any will do.
  layout.marks = print;

  FieldPictures out;
  vision::UnitTiles source(tiles, calibration);
  std::vector<camera::KerfTile> sheet = source.next();
  if (sheet.empty()) {
    out.problems.emplace_back("there are no pictures");
    return out;
  }
  const int unit = sheet.front().unit;
  const vision::UnitPictures pictures =
      vision::viewUnit(std::move(sheet), unit, layout, calibration, scan, out.problems);
  if (unit != 0 || !source.next().empty())
    out.problems.emplace_back("the pictures are of more than one sheet");
  const vision::TileIndex index(pictures.views, calibration);
  const auto place =
      vision::placeUnit(pictures.views, index, {0, &layout, scan.table_sigma_mm}, calibration, out.problems);
  if (!place) return out;
  if (3 * static_cast<std::size_t>(place->marks) < 2 * print.size()) {
    out.problems.push_back(
        fmt::format("only {} of {} printed marks are there: another sheet, or not all of it was looked at",
                    place->marks, print.size()));
  }
  out.pose = {0,           place->X_TS.shift_mm, place->X_TS.angle_rad, place->covariance, place->residual_mm,
              place->marks};
  FieldSearch(calibration, options, scan, pictures, index, place->X_TS).run(out);
  return out;
}

/// As `hil/vision` tells it, which knows of products one after the other; here is but one sheet.
std::string ofSheet(const std::string& problem) {
  constexpr std::string_view kFirst = "unit 0: ";
  return problem.starts_with(kFirst) ? problem.substr(kFirst.size()) : problem;
}

}  // namespace

Eigen::Matrix3d FieldPictures::poseCovarianceAbout(const Vector2d& p_S_mm) const {
  // p_S = R' (p_T - p_TS)
  const Matrix2d R_ST = Eigen::Rotation2Dd(-pose.angle_rad).toRotationMatrix();
  Eigen::Matrix3d by_pose;
  by_pose << -R_ST, Vector2d(p_S_mm.y(), -p_S_mm.x()), Eigen::RowVector3d(0.0, 0.0, -1.0);
  return by_pose * pose.covariance * by_pose.transpose();
}

Matrix2d FieldPictures::poseCovariance(const Vector2d& p_S_mm) const {
  return poseCovarianceAbout(p_S_mm).topLeftCorner<2, 2>();
}

FieldPictures findFieldMarks(camera::TileSource& tiles, const vision::CameraCalibration& calibration,
                             const std::vector<RegistrationMark>& print, const FieldSearchOptions& options) {
  checkOptions(options);
  FieldPictures out = searchSheet(tiles, calibration, print, options);
  std::ranges::transform(out.problems, out.problems.begin(), ofSheet);
  return out;
}

}  // namespace kerfbench::calibrate
