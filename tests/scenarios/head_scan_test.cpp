// SPDX-License-Identifier: Apache-2.0
// Command `calibrate head --by-hand` with a flatbed scanner, from the first sheet to the table: the twin cuts
// each sheet, a scanner's model (tests/hil/calibrate/scanner), which shares nothing with the bench's cameras,
// scans it, and nothing else is measured.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "hil/calibrate/files/target_file.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/camera/png.h"
#include "hil/head_service/head_setup.h"
#include "hil/head_service/sheet_on_twin.h"
#include "tests/hil/calibrate/scanner/scanner_model.h"
#include "tests/scenarios/scenario_runs.h"
#include "twin/base/image.h"

namespace kerfbench::test {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kWaiting = 75;
constexpr int kDensest = 5;
constexpr double kDpi = 400.0;
constexpr double kKerf_mm = 0.2;

void writePicture(const fs::path& path, const GrayImage& image) {
  const std::vector<std::uint8_t> bytes = camera::encodePng(image);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// Where a head puts places of a sheet: at each mark where the twin put it, between them a cubic through all.
class CutPlaces {
 public:
  CutPlaces(const calibrate::MarkJob& job, const head_service::MeasuredSheet& sheet) {
    for (const head_service::MeasuredMark& mark : sheet.marks) {
      centres_.push_back(job.wanted_S_mm(mark.wanted));
      errors_.push_back(mark.error_mm());
    }
    const auto rows = static_cast<Eigen::Index>(centres_.size());
    Eigen::MatrixXd terms(rows, kTerms), errors(rows, 2);
    for (Eigen::Index i = 0; i < rows; ++i) {
      terms.row(i) = termsAt(centres_[static_cast<std::size_t>(i)]).transpose();
      errors.row(i) = errors_[static_cast<std::size_t>(i)].transpose();
    }
    cubic_ = terms.colPivHouseholderQr().solve(errors);
  }

  [[nodiscard]] Vector2d at(const Vector2d& p_S) const {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < centres_.size(); ++i)
      if ((centres_[i] - p_S).norm() < (centres_[nearest] - p_S).norm()) nearest = i;
    return p_S + smoothAt(p_S) + errors_[nearest] - smoothAt(centres_[nearest]);
  }
  [[nodiscard]] double largest_mm() const {
    double most = 0.0;
    for (const Vector2d& error : errors_) most = std::max(most, error.norm());
    return most;
  }

 private:
  static constexpr Eigen::Index kTerms = 10;
  static Eigen::Matrix<double, kTerms, 1> termsAt(const Vector2d& p_mm) {
    const double x = p_mm.x() / 50.0, y = p_mm.y() / 50.0;
    Eigen::Matrix<double, kTerms, 1> terms;
    terms << 1.0, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
    return terms;
  }
  [[nodiscard]] Vector2d smoothAt(const Vector2d& p_mm) const {
    return (termsAt(p_mm).transpose() * cubic_).transpose();
  }

  std::vector<Vector2d> centres_, errors_;
  Eigen::Matrix<double, kTerms, 2> cubic_;
};

class HeadScan : public testing::Test {
 protected:
  HeadScan() : setup_(head_service::readHeadSetup(machine(), kDensest)) {
    scanner_.width_px = scanner_.height_px = 2100;
    scanner_.pitch_mm = 25.4 / kDpi;
    scanner_.p_GS_mm = middle();
  }
  /// Middle of the glass.
  [[nodiscard]] Vector2d middle() const {
    return 0.5 * scanner_.pitch_mm * Vector2d(scanner_.width_px, -scanner_.height_px);
  }
  static fs::path machine() { return fixture("machines/two-mirror-100.yaml"); }
  [[nodiscard]] fs::path path(const std::string& name) const { return scratch_.path() / name; }
  [[nodiscard]] fs::path results() const { return path("head"); }

  /// One scan of the printed target over the whole glass.
  void calibrateScanner() {
    const ProgramRun target = kerfbench(fmt::format(
        "calibrate target --columns 34 --rows 34 --square-mm 4.2 --out '{}'", path("target.svg").string()));
    ASSERT_EQ(target.exit_code, 0) << target.output;
    calibrate::test::ScannerModel with_target = scanner_;
    with_target.turn_rad = -0.009;  // Nobody lays it just as the sheets.
    writePicture(path("glass.png"), with_target.target(calibrate::readTarget(path("target.yaml"))));
    const ProgramRun scanner = kerfbench(fmt::format(
        "calibrate scanner --scan '{}' --target '{}' --dpi {} --date 2026-11-21 --out '{}'",
        path("glass.png").string(), path("target.yaml").string(), kDpi, path("scanner.yaml").string()));
    ASSERT_EQ(scanner.exit_code, 0) << scanner.output;
  }

  [[nodiscard]] ProgramRun calibrateHead() const {
    return kerfbench(
        fmt::format("calibrate head --machine '{}' --seed 2 --grids {} --verify 20 --limit-mm 0.03 --by-hand "
                    "--scanner '{}' --results-dir '{}'",
                    machine().string(), kDensest, path("scanner.yaml").string(), results().string()));
  }

  /// The sheet that is waited for: a folder with a job and without what was measured.
  [[nodiscard]] std::optional<fs::path> waiting() const {
    for (const auto& entry : fs::directory_iterator(results()))
      if (entry.is_directory() && fs::exists(entry.path() / "marks.yaml") &&
          !fs::exists(entry.path() / "measured.yaml"))
        return entry.path();
    return std::nullopt;
  }

  /// Has the twin cut a sheet with the table that lies beside its job, and scans it.
  double cutAndScan(const fs::path& sheet) {
    const calibrate::MarkJob job = calibrate::readMarkJob(sheet / "marks.yaml");
    const fs::path table = sheet / "table.csv";
    const head_service::TwinBench bench{.seed = 2, .bin_dir = fs::path(KERFBENCH_BINARY_DIR) / "bin"};
    const auto cut = head_service::sheetOnTwin(setup_, bench,
                                               {.job = job,
                                                .sheet = sheets_,
                                                .folder = path(fmt::format("twin-{}", sheets_)),
                                                .table = fs::exists(table) ? table : fs::path()},
                                               [](const auto&...) {});
    ++sheets_;
    const CutPlaces places(job, cut.measured);
    scanner_.seed = static_cast<std::uint64_t>(sheets_);
    // The sheet lies with its middle on that of the glass.
    Eigen::AlignedBox2d print;
    for (const RegistrationMark& mark : job.print) print.extend(mark.p_SM_mm);
    scanner_.p_GS_mm = middle() - Eigen::Rotation2Dd(scanner_.turn_rad) * Vector2d(print.center());
    writePicture(sheet / "pictures/scan.png",
                 scanner_.sheet(job, kKerf_mm, [&](const Vector2d& p_S) { return places.at(p_S); }));
    return places.largest_mm();
  }

  ScratchFolder scratch_;
  head_service::HeadSetup setup_;
  calibrate::test::ScannerModel scanner_;
  int sheets_{};
};

TEST_F(HeadScan, OneScanOfEachSheetMakesTheTable) {
  ASSERT_NO_FATAL_FAILURE(calibrateScanner());
  std::vector<double> off_mm;
  ProgramRun last = calibrateHead();
  while (last.exit_code == kWaiting && off_mm.size() < 6) {
    const auto sheet = waiting();
    ASSERT_TRUE(sheet) << last.output;
    EXPECT_THAT(textOf(*sheet / "pictures/scan.yaml"), HasSubstr("scanner: '"));
    off_mm.push_back(cutAndScan(*sheet));
    last = calibrateHead();
  }
  ASSERT_EQ(last.exit_code, 0) << last.output;
  EXPECT_THAT(textOf(results() / "steps.html"), HasSubstr("<div class=big>GOOD</div>"));
  EXPECT_EQ(nlohmann::json::parse(textOf(results() / "steps.json")).at("verdict"), "GOOD");
  EXPECT_FALSE(textOf(results() / "correction.csv").empty());
  // The twin's own camera judges: the head as it was mounted, and with the table that scans alone have made.
  ASSERT_GE(off_mm.size(), 2U);
  EXPECT_GT(off_mm.front(), 0.2);
  EXPECT_LT(off_mm.back(), 0.02);
}

}  // namespace
}  // namespace kerfbench::test
