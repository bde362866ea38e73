// SPDX-License-Identifier: Apache-2.0
// Scanners that are not true, calibrated by the target, and sheets that they scanned.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <exception>
#include <fstream>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/camera/calibrate_camera.h"
#include "hil/calibrate/marks/field_marks.h"
#include "hil/calibrate/scanner/scan_picture.h"
#include "hil/calibrate/scanner/scanner_file.h"
#include "hil/calibrate/scanner/scanner_fit.h"
#include "hil/camera/kerf_tile.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/calibrate/scanner/scanner_model.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
using test::ScannerModel;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kKerf_mm = 0.18;

class OneTile final : public camera::TileSource {
 public:
  explicit OneTile(GrayImage image) : tile_{{std::move(image), Vector2d::Zero(), 0, true}} {}
  std::vector<camera::KerfTile> nextBatch(std::size_t) override { return std::exchange(tile_, {}); }

 private:
  std::vector<camera::KerfTile> tile_;
};

/// 5 x 5 marks over 40 mm, printed marks around them.
MarkJob job() {
  MarkJob job;
  job.name = "scan";
  job.machine = "none";
  job.date = "2026-11-22";
  job.size_mm = 6.0;
  job.p_SW_mm = {1.0, -0.5};
  job.marks = numbered(gridPlaces({Vector2d(-20, -20), Vector2d(20, 20)}, 5), 30);
  for (const double x : {-26.0, 2.5, 26.0})
    for (const double y : {-26.0, 26.0}) job.print.push_back({job.p_SW_mm + Vector2d(x, y), 3.0});
  return job;
}

/// Known errors of a head: a scale, a turn and a bow, up to 0.3 mm.
Vector2d off(const Vector2d& p) {
  return {p.x() * 1.006 - 0.002 * p.y() + 1e-4 * p.y() * p.y(),
          p.y() * 0.997 + 0.003 * p.x() - 2e-4 * p.x() * p.y()};
}

CalibrationTarget targetForGlass() {
  return {.columns = 18, .rows = 18, .square_mm = 3.8, .marker_mm = 2.28};
}

ScannerCalibration calibrated(const ScannerModel& scanner) {
  ScannerModel with_target = scanner;
  with_target.turn_rad = -0.011;  // The target was laid otherwise than the sheet.
  with_target.p_GS_mm = {31.7, -31.8};
  return calibrateScanner(with_target.target(targetForGlass()),
                          {targetForGlass(), "glass-1", "2026-11-22", 600.0});
}

FieldPictures measured(const GrayImage& scan, const ScannerMap& map, ScanLid lid = ScanLid::kBlack) {
  StraightScan straight = straightened(scan, map, lid, job().print);
  OneTile tile(std::move(straight.image));
  FieldSearchOptions options;
  options.size_mm = job().size_mm;
  options.open_gray = kScanOpenGray;
  options.beam_radius_mm = 0.5 * kKerf_mm;
  options.threads = 2;
  return findFieldMarks(tile, straight.camera, job().print, options);
}

/// RMS per axis and worst of the marks' errors against where the head put them, mm.
struct Errors {
  double rms{}, worst{}, scale{};
};
Errors errorsOf(const MarkedField& field) {
  Errors errors;
  double sum = 0.0, along = 0.0, reach = 0.0;
  for (const MarkPoint& point : field.points) {
    const Vector2d p = job().wanted_S_mm(point.wanted), miss = point.cut.p_S_mm - off(p);
    sum += 0.5 * miss.squaredNorm();
    errors.worst = std::max(errors.worst, miss.norm());
    along += miss.dot(p);
    reach += p.squaredNorm();
  }
  errors.rms = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, field.points.size())));
  errors.scale = along / reach;
  return errors;
}

class Scanner : public testing::Test {
 protected:
  static void SetUpTestSuite() { calibration_ = std::make_unique<ScannerCalibration>(calibrated({})); }
  static void TearDownTestSuite() { calibration_.reset(); }
  static std::unique_ptr<ScannerCalibration> calibration_;
};
std::unique_ptr<ScannerCalibration> Scanner::calibration_;

TEST_F(Scanner, ItsMapIsFoundByTheTargetToMicrometres) {
  const ScannerModel model;
  const ScannerMap& map = calibration_->map;
  // Both maps may differ by a rigid motion: the target's place on the glass is nobody's.
  std::vector<Vector2d> seen, truth;
  for (int i = 0; i < 81; ++i) {
    const Vector2d pixel(80.0 + 165.0 * (i % 9), 80.0 + 165.0 * (i / 9));
    seen.push_back(map.glassFromPixel(pixel));
    truth.push_back(model.glassAt(pixel));
    EXPECT_LT((map.pixelFromGlass(seen.back()) - pixel).norm(), 1e-5);
  }
  Eigen::Matrix2Xd from(2, 81), to(2, 81);
  for (Eigen::Index i = 0; i < 81; ++i) {
    from.col(i) = seen[static_cast<std::size_t>(i)];
    to.col(i) = truth[static_cast<std::size_t>(i)];
  }
  const Eigen::Matrix3d rigid = Eigen::umeyama(from, to, false);
  const Eigen::Matrix2Xd left =
      (rigid.topLeftCorner<2, 2>() * from).colwise() + rigid.topRightCorner<2, 1>() - to;
  const double rms = std::sqrt(left.squaredNorm() / (2.0 * 81.0));
  EXPECT_LT(rms, 0.003);
  EXPECT_LT(rms, 2.0 * calibration_->map_u_mm);
  EXPECT_LT(calibration_->map_u_mm, 0.006);
  EXPECT_NEAR(map.mm_per_px(0, 0) / model.pitch_mm, model.scale.x(), 3e-4);
}

TEST_F(Scanner, AHeadsErrorsAreMeasuredFromOneScanOnABlackLidAndOnAWhiteOne) {
  for (const ScanLid lid : {ScanLid::kBlack, ScanLid::kWhite}) {
    ScannerModel scanner;
    if (lid == ScanLid::kWhite) {
      scanner.lid_gray = 248.0;
      scanner.board_gray = 150.0;
    }
    const FieldPictures pictures = measured(scanner.sheet(job(), kKerf_mm, off), calibration_->map, lid);
    ASSERT_THAT(pictures.problems, IsEmpty());
    const MarkedField field = matchField(job(), pictures);
    ASSERT_THAT(field.problems, IsEmpty());
    EXPECT_EQ(field.points.size(), 25U);
    const Errors errors = errorsOf(field);
    EXPECT_LT(errors.rms, 0.003);
    EXPECT_LT(errors.worst, 0.008);
    EXPECT_LT(std::abs(errors.scale), 1e-4);
  }
}

TEST_F(Scanner, TakenOnTrustItsScaleAndItsCarriageAreTheHeads) {
  const ScannerModel scanner;
  const ScannerMap trusted = ScannerMap::ofResolution(scanner.width_px, scanner.height_px, 600.0);
  const MarkedField field = matchField(job(), measured(scanner.sheet(job(), kKerf_mm, off), trusted));
  EXPECT_GT(errorsOf(field).rms, 0.015);
}

TEST_F(Scanner, ACalibrationIsReadBackAndABadOneRefused) {
  const base::TempFolder temp;
  const auto path = temp.path() / "scanner.yaml";
  const std::string text = scannerText(*calibration_, "kerfbench calibrate scanner");
  std::ofstream(path) << text;
  EXPECT_EQ(scannerText(readScannerFile(path), "kerfbench calibrate scanner"), text);
  std::string bad = text;
  bad.replace(bad.find("dpi: 600"), 8, "dpi: -1");
  std::ofstream(path) << bad.substr(0, bad.find("map_u_mm"));
  try {
    readScannerFile(path);
    FAIL();
  } catch (const base::ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("dpi"));
    EXPECT_THAT(error.what(), HasSubstr("map_u_mm"));
  }
}

std::string refusalOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST_F(Scanner, BadScansAreRefusedByName) {
  const ScannerModel scanner;
  const GrayImage good = scanner.sheet(job(), kKerf_mm, off);
  const auto refusal = [&](const GrayImage& scan, double dpi) {
    return refusalOf([&] { measured(scan, ScannerMap::ofResolution(scan.width, scan.height, dpi)); });
  };
  EXPECT_THAT(refusal(good, 300.0), HasSubstr("by its printed marks the scan has about "));
  EXPECT_THAT(refusal(good, 300.0), HasSubstr("dpi, not 300"));
  EXPECT_THAT(refusal(GrayImage(800, 800, 200), 600.0), HasSubstr("0 of 6 printed marks are there"));
  ScannerModel pale = scanner;
  pale.ink_gray = pale.board_gray - 30.0;
  EXPECT_NE(refusal(pale.sheet(job(), kKerf_mm, off), 600.0), "");
  // Cut off: one column of printed marks lies beyond the glass.
  ScannerModel small = scanner;
  small.width_px = 1150;
  EXPECT_THAT(refusal(small.sheet(job(), kKerf_mm, off), 600.0),
              HasSubstr("4 of 6 printed marks are there: another sheet, or not all of it was scanned"));
  // Another sheet.
  MarkJob other = job();
  other.marks = numbered(gridPlaces({Vector2d(-20, -20), Vector2d(20, 20)}, 5), 200);
  const MarkedField foreign =
      matchField(job(), measured(scanner.sheet(other, kKerf_mm, off), calibration_->map));
  EXPECT_THAT(foreign.problems, testing::Contains(HasSubstr("another job's sheet")));
  for (const auto& [turn_rad, words] : {std::pair{1.5707963267948966, "by a quarter turn to the left"},
                                        {3.141592653589793, "upside down"},
                                        {-1.5707963267948966, "by a quarter turn to the right"}}) {
    ScannerModel turned = scanner;
    turned.turn_rad += turn_rad;
    EXPECT_THAT(refusal(turned.sheet(job(), kKerf_mm, off), 600.0), HasSubstr(words));
  }
}

TEST_F(Scanner, ABadScanOfTheTargetIsRefusedByName) {
  ScannerModel model;
  model.turn_rad = 0.0;
  const auto refusal = [&](const CalibrationTarget& target, double dpi) {
    return refusalOf([&] {
      calibrateScanner(model.target(targetForGlass()), {target, "g", "2026-11-22", dpi});
    });
  };
  EXPECT_THAT(refusal(targetForGlass(), 300.0), HasSubstr("by the target's squares the scan has 6"));
  model.width_px = 900;
  model.height_px = 900;
  CalibrationTarget small = targetForGlass();
  small.columns = small.rows = 5;
  const auto blank = [&] { calibrateScanner(GrayImage(500, 500, 200), {small, "g", "2026-11-22", 600.0}); };
  EXPECT_THAT(refusalOf(blank), HasSubstr("the scan is"));
  ScannerModel part;
  part.p_GS_mm = {12.0, -31.8};
  EXPECT_THAT(
      refusalOf([&] {
        calibrateScanner(
            part.target({.columns = 10, .rows = 18, .square_mm = 3.8, .marker_mm = 2.28}),
            {{.columns = 10, .rows = 18, .square_mm = 3.8, .marker_mm = 2.28}, "g", "2026-11-22", 600.0});
      }),
      HasSubstr("of the glass along the sensor bar"));
}

}  // namespace
}  // namespace kerfbench::calibrate
