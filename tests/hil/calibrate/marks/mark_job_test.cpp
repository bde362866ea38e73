// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_job.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/calibrate/marks/verify_places.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using testing::HasSubstr;
using testing::Not;

const AlignedBox2d kField(Vector2d(-50.0, -50.0), Vector2d(50.0, 50.0));

MarkJob job(int n = 17) {
  MarkJob job;
  job.name = "first's";
  job.machine = "two-mirror-100";
  job.date = "2026-11-22";
  job.size_mm = 5.0;
  job.p_SW_mm = {-67.0, 0.125};
  for (const double x : {-56.0, 56.0}) {
    for (const double y : {-56.0, 56.0}) job.print.push_back({job.p_SW_mm + Vector2d(x, y), 3.0});
  }
  job.marks = numbered(gridPlaces(kField, n), 9);
  return job;
}

double distance(const MarkStroke& a, const MarkStroke& b) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 20; ++i) {
    const Vector2d p = a.from_mm + i / 20.0 * (a.to_mm - a.from_mm);
    least = std::min(least, dieline::nearestOn(dieline::LineCurve{b.from_mm, b.to_mm}, p).distance_mm);
  }
  return least;
}

TEST(MarkPattern, CutsOfTheWidestKerfLeaveBoardBetweenThem) {
  constexpr double kSize_mm = 5.0;
  constexpr double kKerf_mm = kWidestKerf * kSize_mm;
  for (int number = 0; number < kMarkNumbers; ++number) {
    std::vector<MarkStroke> strokes = markTicks(number, kSize_mm);
    ASSERT_EQ(strokes.size(), static_cast<std::size_t>(kMarkTicks));
    for (const MarkStroke& arm : markArms(kSize_mm)) strokes.push_back(arm);
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_GT(distance(strokes[i], strokes[j]), 1.25 * kKerf_mm) << number << ": " << i << ", " << j;
      for (const Vector2d& p : {strokes[i].from_mm, strokes[i].to_mm})
        ASSERT_LE(p.cwiseAbs().maxCoeff(), 0.5 * kMarkReach * kSize_mm);
    }
  }
}

// The rule must hold for any numbers, and for any place of the neighbour.
TEST(MarkPattern, MarksThatLieAsNearAsTheyMayLeaveBoardBetweenThem) {
  constexpr double kSize_mm = 5.0;
  std::vector<MarkStroke> all;
  MarkWord seen;
  for (int number = 0; number < kMarkNumbers; ++number) {
    if ((markWord(number) & ~seen).none()) continue;
    seen |= markWord(number);
    for (const MarkStroke& tick : markTicks(number, kSize_mm)) all.push_back(tick);
  }
  ASSERT_TRUE(seen.all());
  for (const MarkStroke& arm : markArms(kSize_mm)) all.push_back(arm);
  for (int degrees = 0; degrees < 180; degrees += 3) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vector2d direction(std::cos(angle), std::sin(angle));
    const Vector2d way = kMarkPitch * kSize_mm / direction.cwiseAbs().maxCoeff() * direction;
    for (const MarkStroke& a : all) {
      for (const MarkStroke& b : all)
        ASSERT_GT(distance(a, {b.from_mm + way, b.to_mm + way}), 1.25 * kWidestKerf * kSize_mm) << degrees;
    }
  }
}

// A mirrored head must be visible in the arms of its marks, and steps of mirrors or pixels must average out.
TEST(MarkPattern, ArmsRunAlongNoAxisAndCrossAtTheCentre) {
  const auto arms = markArms(5.0);
  Vector2d sum(0.0, 0.0);
  for (const MarkStroke& arm : arms) {
    const Vector2d way = arm.to_mm - arm.from_mm;
    EXPECT_NEAR(std::abs(arm.from_mm.x() * arm.to_mm.y() - arm.from_mm.y() * arm.to_mm.x()), 0.0, 1e-12);
    EXPECT_NEAR(std::min(std::abs(way.x()), std::abs(way.y())) / way.norm(), 1.0 / std::sqrt(17.0), 1e-12);
    sum += arm.to_mm;
  }
  EXPECT_LT(sum.norm(), 1e-12);
}

TEST(MarkJob, ADenseGridOf100MillimetresHasRoom) {
  EXPECT_DOUBLE_EQ(markSizeFor(100.0 / 16.0, 0.25), 5.0);
  EXPECT_TRUE(job().faults().empty());
  EXPECT_EQ(job().marks.size(), 289U);
  EXPECT_THROW(static_cast<void>(markSizeFor(3.0, 0.25)), std::invalid_argument);
}

TEST(MarkJob, ItsDrawingIsReadAsItIsMeant) {
  const base::TempFolder folder;
  const std::filesystem::path path = folder.path() / "first.yaml";
  writeMarkJob(path, job());
  const dieline::Dieline read =
      dieline::readDieline(folder.path() / "first.dxf", dieline::defaultLayerProfile());
  const dieline::Dieline meant = job().dieline();
  ASSERT_EQ(read.entities.size(), meant.entities.size());
  ASSERT_EQ(read.entities.size(), 289U * 9U);
  for (std::size_t i = 0; i < read.entities.size(); ++i) {
    EXPECT_EQ(read.entities[i].process, dieline::Process::kCut);
    for (const double u : {0.0, 1.0})
      ASSERT_LT(
          (dieline::pointAt(read.entities[i].curve, u) - dieline::pointAt(meant.entities[i].curve, u)).norm(),
          2e-9);
  }
  for (const dieline::LintFinding& finding : dieline::lintDieline(read))
    EXPECT_FALSE(finding.is_error) << finding.message;
}

TEST(MarkJob, IsReadBackAndWrittenAgainAsTheSameBytes) {
  const base::TempFolder folder;
  const std::filesystem::path path = folder.path() / "first.yaml";
  writeMarkJob(path, job());
  const MarkJob back = readMarkJob(path);
  EXPECT_EQ(back.name, "first's");
  EXPECT_EQ(markJobText(back), base::contentOf(path));
  EXPECT_EQ(markJobDxf(back), base::contentOf(folder.path() / "first.dxf"));
  EXPECT_EQ(markJobDigest(back), markJobDigest(job()));
  MarkJob other = job();
  other.marks[7].p_W_mm.x() += 1e-6;
  EXPECT_NE(markJobDigest(other), markJobDigest(job()));
}

TEST(MarkJob, TellsEveryFaultWithItsLine) {
  const base::TempFolder folder;
  const std::filesystem::path path = folder.path() / "bad.yaml";
  std::ofstream(path) << "version: 1\n"
                         "digest: ''\n"
                         "name: bad\n"
                         "machine: ''\n"
                         "date: yesterday\n"
                         "size_mm: 500\n"
                         "p_SW_mm: [0, 0]\n"
                         "print:\n"
                         "  - {p_S_mm: [9, 9], diameter_mm: 3}\n"
                         "marks:\n"
                         "  - {number: 4, p_W_mm: [0, 0]}\n"
                         "  - {number: 4, p_W_mm: [50, 0], colour: red}\n"
                         "  - {number: 1120, p_W_mm: [0, 1e7]}\n";
  try {
    static_cast<void>(readMarkJob(path));
    FAIL() << "must not be read";
  } catch (const base::ConfigError& e) {
    const std::string what = e.what();
    for (const char* fault :
         {":4: machine: is empty", ":5: date: is no day", ":6: size_mm: must be 4.5 … 100",
          ":8: print: must have two marks", ":12: marks[1].number: 4 is there twice",
          ":12: marks[1].colour: unknown key", ":13: marks[2].number: must be 0 … 1119, is 1120",
          ":13: marks[2].p_W_mm: lies too far away"})
      EXPECT_THAT(what, HasSubstr(fault));
  }
}

TEST(MarkJob, MarksThatTouchOrLieOnPrintAreRefusedAndNothingIsWritten) {
  const base::TempFolder folder;
  const std::filesystem::path path = folder.path() / "tight.yaml";
  MarkJob tight = job();
  tight.marks[3].p_W_mm += Vector2d(0.5, 0.0);
  tight.print.push_back({tight.wanted_S_mm(tight.marks[40]), 3.0});
  try {
    writeMarkJob(path, tight);
    FAIL() << "must not be written";
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(), HasSubstr("mm from mark"));
    EXPECT_THAT(e.what(), HasSubstr("mark 49 lies on the printed mark"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "tight.dxf"));
}

TEST(MarkJob, AFileThatWasEditedIsRefused) {
  const base::TempFolder folder;
  const std::filesystem::path path = folder.path() / "first.yaml";
  std::string text = markJobText(job(3));
  const auto at = text.find("p_W_mm: [0.000000000, 0.000000000]");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 22, "p_W_mm: [0.001000000, ");
  std::ofstream(path) << text;
  try {
    static_cast<void>(readMarkJob(path));
    FAIL() << "must not be read";
  } catch (const base::ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("digest: does not fit"));
  }
}

TEST(MarkPlaces, AGridHasItsRimAndGoesToAndFro) {
  const auto places = gridPlaces(kField, 3);
  ASSERT_EQ(places.size(), 9U);
  EXPECT_EQ(places[0], Vector2d(-50.0, -50.0));
  EXPECT_EQ(places[2], Vector2d(50.0, -50.0));
  EXPECT_EQ(places[3], Vector2d(50.0, 0.0));
  EXPECT_EQ(places[8], Vector2d(50.0, 50.0));
  EXPECT_THROW(static_cast<void>(gridPlaces(kField, 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(gridPlaces(AlignedBox2d(), 3)), std::invalid_argument);
}

TEST(MarkPlaces, RandomOnesKeepApartAndReachTheRimAndDependOnTheirSeedAlone) {
  RandomPlaces request;
  request.count = 150;
  request.apart_mm = 5.5;
  request.known = gridPlaces(kField, 9);
  request.from_known_mm = 2.0;
  request.seed = 5;
  const auto places = randomPlaces(kField, request);
  ASSERT_EQ(places.size(), 150U);
  int on_rim = 0;
  Vector2d mean(0.0, 0.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    ASSERT_TRUE(kField.contains(places[i]));
    mean += places[i] / 150.0;
    if (places[i].cwiseAbs().maxCoeff() == 50.0) ++on_rim;
    for (std::size_t j = 0; j < i; ++j) ASSERT_GE(marksApart_mm(places[i], places[j]), 5.5);
    for (const Vector2d& known : request.known) ASSERT_GE(marksApart_mm(places[i], known), 2.0);
  }
  EXPECT_EQ(on_rim, 15);
  EXPECT_LT(mean.norm(), 10.0);  // Evenly: one standard deviation is 2 mm each way.
  EXPECT_EQ(randomPlaces(kField, request), places);
  request.seed = 6;
  EXPECT_NE(randomPlaces(kField, request), places);
  request.count = 1500;
  EXPECT_THROW(static_cast<void>(randomPlaces(kField, request)), std::invalid_argument);
}

TEST(MarkPlaces, VerifyingManyTakesSeveralSheetsWithRimAndMiddlesOfCellsOnEach) {
  VerifyPlaces request;
  request.count = 401;
  request.mark_size_mm = 5.0;
  request.marked = gridPlaces(kField, 17);
  for (int i = 0; i < 64; ++i) request.middles.emplace_back(-45.1 + 13.0 * (i % 8), -45.1 + 13.0 * (i / 8));
  request.seed = 7;
  const auto sheets = verifySheets(kField, request);
  ASSERT_EQ(sheets.size(), 4U);
  std::size_t count = 0;
  std::set<std::pair<double, double>> middles;
  for (const auto& places : sheets) {
    count += places.size();
    EXPECT_NEAR(static_cast<double>(places.size()), 100.25, 1.0);
    std::size_t on_rim = 0;
    std::size_t on_middle = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i].cwiseAbs().maxCoeff() == 50.0) ++on_rim;
      if (std::ranges::find(request.middles, places[i]) != request.middles.end()) {
        ++on_middle;
        EXPECT_TRUE(middles.emplace(places[i].x(), places[i].y()).second);
      }
      for (std::size_t j = 0; j < i; ++j) ASSERT_GE(marksApart_mm(places[i], places[j]), 6.25);
      for (const Vector2d& marked : request.marked) ASSERT_GE(marksApart_mm(places[i], marked), 1.25);
    }
    EXPECT_GE(on_rim, 10U);
    EXPECT_LE(on_rim, 11U);
    // Nearly a tenth: of the 64 middles only 39 lie clear of the marks of the grid.
    EXPECT_GE(on_middle, 9U);
    EXPECT_LE(on_middle, 10U);
  }
  EXPECT_EQ(count, 401U);
  EXPECT_EQ(verifySheets(kField, request), sheets);
  EXPECT_NE(sheets[0], sheets[1]);
  request.seed = 8;
  EXPECT_NE(verifySheets(kField, request), sheets);
}

TEST(MarkPlaces, VerifyingFewTakesOneSheetAndNoRoomIsRefused) {
  VerifyPlaces request;
  request.count = 20;
  request.mark_size_mm = 5.0;
  EXPECT_EQ(verifySheets(kField, request).size(), 1U);
  request.mark_size_mm = 0.0;
  EXPECT_THROW(static_cast<void>(verifySheets(kField, request)), std::invalid_argument);
  request.mark_size_mm = 30.0;
  request.marked = gridPlaces(kField, 17);  // Every place lies beside one of them.
  EXPECT_THROW(static_cast<void>(verifySheets(kField, request)), std::invalid_argument);
}

TEST(MarkPlaces, NumbersRunOnFromJobToJob) {
  const auto places = gridPlaces(kField, 3);
  const auto marks = numbered(places, 9);
  EXPECT_EQ(marks.front().number, 9);
  EXPECT_EQ(marks.back().number, 17);
  EXPECT_THROW(static_cast<void>(numbered(places, kMarkNumbers - 8)), std::out_of_range);
}

}  // namespace
}  // namespace kerfbench::calibrate
