// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/field_marks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/LU>

#include "hil/base/yaml_reader.h"
#include "hil/camera/kerf_tile.h"
#include "hil/camera/tile_folder.h"
#include "hil/vision/marks/constellation.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/calibrate/marks/marked_sheet.h"
#include "tests/hil/vision/synthetic.h"
#include "twin/base/image.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using test::MarkedSheet;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A head that bows, turns, scales and shifts by millimetres.
Vector2d bowed(const Vector2d& p) {
  return {1.02 * p.x() + 0.03 * p.y() + 4e-4 * p.x() * p.y() + 2.3,
          0.985 * p.y() - 0.02 * p.x() + 3e-4 * p.x() * p.x() - 1.7};
}

/// Errors of centres without their common part, which is the pose's.
struct Errors {
  int count{};
  Vector2d bias_um{Vector2d::Zero()};  ///< Mean over all, pose included.
  double sigma_um{};                   ///< Standard deviation per axis, after the best motion of each sheet.
  double stated_um{};                  ///< RMS of the stated uncertainties, per axis.
  double mahalanobis{};  ///< Mean of e' covariance^-1 e, 2 if honest; less the part of the motion.
  double worst_um{};     ///< Largest error, pose included.
};

Errors errorsOf(MarkedSheet& sheet, int seeds) {
  Errors e;
  for (int seed = 1; seed <= seeds; ++seed) {
    sheet.seed = sheet.camera.board_seed = static_cast<std::uint64_t>(seed);
    const FieldPictures pictures = sheet.find();
    for (const DamagedMark& mark : pictures.damaged) ADD_FAILURE() << mark.reason;
    const MarkedField field = matchField(sheet.job, pictures);
    EXPECT_EQ(field.points.size(), sheet.job.marks.size());
    EXPECT_THAT(field.problems, IsEmpty());
    std::vector<vision::MarkPair> pairs;
    for (const MarkPoint& point : field.points)
      pairs.push_back({sheet.head(sheet.job.wanted_S_mm(point.wanted)), point.cut.p_S_mm, 0.0});
    const vision::PlaneMotion common = vision::fitMotion(pairs, 0.0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Matrix2d covariance = field.points[i].cut.covariance;
      const Vector2d own = pairs[i].q_mm - common * pairs[i].p_mm;
      const Vector2d whole = pairs[i].q_mm - pairs[i].p_mm;
      ++e.count;
      e.bias_um += 1e3 * whole;
      e.sigma_um += 1e6 * 0.5 * own.squaredNorm();
      e.stated_um += 1e6 * 0.5 * covariance.trace();
      e.mahalanobis += own.dot(covariance.inverse() * own);
      e.worst_um = std::max(e.worst_um, 1e3 * whole.norm());
    }
  }
  e.bias_um /= e.count;
  e.sigma_um = std::sqrt(e.sigma_um / e.count);
  e.stated_um = std::sqrt(e.stated_um / e.count);
  e.mahalanobis /= e.count;
  return e;
}

void report(const char* name, const Errors& e) {
  std::printf(
      "  %-10s %d marks: bias %.3f %.3f um, sigma %.3f um, stated %.3f um, worst %.2f um, Mahalanobis %.2f "
      "of 2\n",
      name, e.count, e.bias_um.x(), e.bias_um.y(), e.sigma_um, e.stated_um, e.worst_um, e.mahalanobis);
}

TEST(FieldMarks, AllAreFoundWhereTheHeadPutThem) {
  MarkedSheet sheet(8, 5, 40);
  sheet.head = bowed;
  const FieldPictures pictures = sheet.find();
  EXPECT_THAT(pictures.problems, IsEmpty());
  EXPECT_THAT(pictures.damaged, IsEmpty());
  EXPECT_EQ(pictures.strays, 0);
  const MarkedField field = matchField(sheet.job, pictures);
  ASSERT_EQ(field.points.size(), 40U);
  EXPECT_THAT(field.remarks, IsEmpty());
  for (const MarkPoint& point : field.points) {
    const Vector2d p_S_mm = sheet.job.wanted_S_mm(point.wanted);
    EXPECT_LT((point.cut.p_S_mm - bowed(p_S_mm)).norm(), 2e-3) << point.wanted.number;
    EXPECT_NEAR((point.error_mm(sheet.job) - (bowed(p_S_mm) - p_S_mm)).norm(), 0.0, 2e-3);
    Matrix2d jacobian;
    for (int i = 0; i < 2; ++i) {
      const Vector2d d = 1e-3 * Vector2d::Unit(i);
      jacobian.col(i) = (bowed(p_S_mm + d) - bowed(p_S_mm - d)) / 2e-3;
    }
    EXPECT_LT((point.cut.as_cut - jacobian).norm(), 0.03);
  }
}

TEST(FieldMarks, CentresAreGoodToAMicrometreAndTheirCovarianceIsHonest) {
  struct Case {
    const char* name;
    std::function<void(MarkedSheet&)> apply;
  };
  const std::vector<Case> cases{
      {"clean", [](MarkedSheet&) {}},
      {"bowed", [](MarkedSheet& s) { s.head = bowed; }},
      {"noisy", [](MarkedSheet& s) { s.camera.read_noise = 2.5; }},
      {"grain", [](MarkedSheet& s) { s.camera.texture = {.grain_gray = 3.0, .grain_length_mm = 0.1}; }},
      {"rough", [](MarkedSheet& s) { s.camera.roughness = {.rms_mm = 0.005, .length_mm = 0.06}; }},
  };
  for (const Case& one : cases) {
    MarkedSheet sheet(8, 5);
    one.apply(sheet);
    const Errors e = errorsOf(sheet, 2);
    report(one.name, e);
    EXPECT_LT(e.bias_um.norm(), 1.0) << one.name;
    EXPECT_LT(e.sigma_um, 3.0) << one.name;
    // The mean of 80 honest marks is 2 +- 0.22 at one sigma.
    EXPECT_GT(e.mahalanobis, 1.0) << one.name;
    EXPECT_LT(e.mahalanobis, 3.0) << one.name;
  }
}

TEST(FieldMarks, AFieldThatIsMirroredSwappedOrTurnedIsReadAndToldInWords) {
  struct Case {
    Matrix2d head;
    const char* words;
  };
  const auto matrix = [](double a, double b, double c, double d) {
    Matrix2d m;
    m << a, b, c, d;
    return m;
  };
  const std::vector<Case> cases{
      {matrix(1, 0, 0, 1), ""},
      {matrix(-1, 0, 0, 1), "mirrored: x runs backwards"},
      {matrix(1, 0, 0, -1), "mirrored: y runs backwards"},
      {matrix(0, 1, 1, 0), "mirrored at a diagonal: x and y are swapped"},
      {matrix(0, -1, -1, 0), "mirrored at a diagonal: x and y are swapped, and both run backwards"},
      {matrix(0, -1, 1, 0), "turned by 90 degrees"},
      {matrix(-1, 0, 0, -1), "turned by 180 degrees"},
      {matrix(0, 1, -1, 0), "turned by 270 degrees"},
  };
  for (const Case& one : cases) {
    MarkedSheet sheet(4, 4, 100);
    const Vector2d middle_mm = sheet.job.p_SW_mm;
    // The head is turned by three degrees on top of its other errors.
    const Matrix2d head = Eigen::Rotation2Dd(0.05).toRotationMatrix() * one.head;
    sheet.head = [&](const Vector2d& p) { return Vector2d(middle_mm + head * (p - middle_mm)); };
    const MarkedField field = sheet.match();
    EXPECT_THAT(field.problems, IsEmpty()) << one.words;
    ASSERT_EQ(field.points.size(), 16U) << one.words;
    for (const MarkPoint& point : field.points) {
      EXPECT_LT((point.cut.p_S_mm - sheet.head(sheet.job.wanted_S_mm(point.wanted))).norm(), 2e-3);
      EXPECT_LT((point.cut.as_cut - head).norm(), 0.03) << one.words;
    }
    if (*one.words == '\0') {
      EXPECT_THAT(field.remarks, IsEmpty());
    } else {
      EXPECT_THAT(field.remarks, ElementsAre(HasSubstr(one.words)));
    }
  }
}

TEST(FieldMarks, WhatIsDamagedMissingOrStrayIsToldAndNotMeasured) {
  MarkedSheet sheet(5, 4);
  sheet.skipped = {{3, 1}, {7, 5}, {12, 0}, {12, 1}, {12, 2}, {12, 3}};
  for (int s = 4; s < 9; ++s) sheet.skipped.insert({12, s});  // The strokes of mark 12 are all left out.
  sheet.also = [](MarkedSheet& s, twin::Sheet& board) {
    const Vector2d nine = s.job.wanted_S_mm(s.job.marks[9]);
    // The sheet has a tick too many; a scratch across an arm of mark 16; one away from everything.
    for (int slot = 0; slot < kMarkSlots; ++slot) {
      if (markWord(9).test(static_cast<std::size_t>(slot))) continue;
      const Vector2d p = nine + 2.5 * (Eigen::Rotation2Dd(kMarkTurn_rad) * slotCentre(slot));
      s.burn(board, p - Vector2d(0.1, 0.1), p + Vector2d(0.1, 0.1));
      break;
    }
    const Vector2d sixteen = s.job.wanted_S_mm(s.job.marks[16]);
    s.burn(board, sixteen + Vector2d(1.2, -0.8), sixteen + Vector2d(1.6, 1.5));
    s.burn(board, Vector2d(-16.0, -5.0), Vector2d(-15.0, 5.0));
  };
  const FieldPictures pictures = sheet.find();
  const MarkedField field = matchField(sheet.job, pictures);
  EXPECT_THAT(field.missing, ElementsAre(3, 7, 9, 12, 16));
  EXPECT_EQ(field.points.size(), 15U);
  EXPECT_THAT(field.problems, IsEmpty());
  std::string words;
  for (const std::string& remark : field.remarks) words += remark + "\n";
  EXPECT_THAT(words, HasSubstr("5 marks not found: 3, 7, 9, 12, 16"));
  EXPECT_THAT(words, HasSubstr("has 4 ticks; 5 make a number"));
  EXPECT_THAT(words, HasSubstr("has 6 ticks; 5 make a number"));
  EXPECT_THAT(words, HasSubstr("lacks an arm"));
  EXPECT_EQ(pictures.damaged.size(), 4U) << words;
  EXPECT_EQ(pictures.strays, 1) << words;
}

TEST(FieldMarks, DoubledMarksAreNotUsed) {
  MarkedSheet sheet(5, 4);
  MarkedSheet wrong = sheet;
  wrong.job.marks[10].number = 4;
  const MarkedField field = matchField(sheet.job, wrong.find());
  EXPECT_THAT(field.doubled, ElementsAre(4));
  EXPECT_THAT(field.missing, ElementsAre(10));
  EXPECT_EQ(field.points.size(), 18U);
  EXPECT_THAT(field.problems, IsEmpty());
  EXPECT_THAT(field.remarks, ElementsAre("1 mark not found: 10", "1 mark found more than once, not used: 4"));
}

TEST(FieldMarks, TwoSheetsMixedAreRefused) {
  MarkedSheet sheet(5, 4);
  const FieldPictures once = sheet.find();
  FieldPictures twice = once;
  for (FieldMark mark : once.marks) {
    mark.p_S_mm.x() += 0.3;
    twice.marks.push_back(mark);
  }
  const MarkedField field = matchField(sheet.job, twice);
  EXPECT_THAT(field.points, IsEmpty());
  ASSERT_FALSE(field.problems.empty());
  EXPECT_THAT(field.problems.front(), HasSubstr("20 marks are there more than once: two sheets are mixed"));
}

TEST(FieldMarks, AnotherJobsSheetIsRefused) {
  MarkedSheet sheet(4, 3, 50);
  const FieldPictures pictures = sheet.find();
  MarkJob other = sheet.job;
  for (WantedMark& mark : other.marks) mark.number += 500;
  const MarkedField field = matchField(other, pictures);
  EXPECT_THAT(field.points, IsEmpty());
  ASSERT_EQ(field.problems.size(), 2U);
  EXPECT_THAT(field.problems[0], HasSubstr("12 of 12 marks found are none of the job's"));
  EXPECT_THAT(field.problems[1], HasSubstr("only 0 of 12 marks can be used"));
}

TEST(FieldMarks, PicturesThatCannotBeUsedSayWhy) {
  MarkedSheet sheet(3, 3);
  const auto tiles = sheet.tiles();
  EXPECT_THAT(sheet.find({}).problems, ElementsAre("there are no pictures"));

  auto dark = tiles;
  for (camera::KerfTile& tile : dark) std::ranges::fill(tile.image.pixels, std::uint8_t{2});
  EXPECT_FALSE(sheet.find(dark).problems.empty());

  auto mixed = tiles;
  mixed.push_back(tiles.back());
  mixed.back().unit = 1;
  EXPECT_THAT(sheet.find(mixed).problems, ElementsAre("the pictures are of more than one sheet"));

  MarkedSheet elsewhere = sheet;
  for (RegistrationMark& mark : elsewhere.job.print) mark.p_SM_mm.x() *= 1.15;
  EXPECT_THAT(elsewhere.find(tiles).problems, ElementsAre(HasSubstr("only 2 of 6 printed marks are there")));

  auto cropped = tiles;
  cropped.front().image = GrayImage(64, 64, 30);
  EXPECT_THROW(static_cast<void>(sheet.find(cropped)), std::invalid_argument);
}

TEST(FieldMarks, TheResultIsTheSameAtAnyNumberOfThreads) {
  MarkedSheet sheet(5, 4);
  sheet.head = bowed;
  const auto tiles = sheet.tiles();
  sheet.threads = 1;
  const FieldPictures one = sheet.find(tiles);
  sheet.threads = 3;
  const FieldPictures three = sheet.find(tiles);
  ASSERT_EQ(one.marks.size(), three.marks.size());
  for (std::size_t i = 0; i < one.marks.size(); ++i) {
    EXPECT_EQ(one.marks[i].p_S_mm, three.marks[i].p_S_mm);
    EXPECT_EQ(one.marks[i].covariance, three.marks[i].covariance);
  }
}

TEST(FieldMarks, AFolderOfPicturesGivesTheSameToTheLastBit) {
  const base::TempFolder folder;
  MarkedSheet sheet(4, 3);
  const auto tiles = sheet.tiles();
  vision::test::ReadyTiles live(tiles);
  camera::writeTiles(live, folder.path() / "tiles");
  camera::TileFolder stored(folder.path() / "tiles");
  EXPECT_EQ(stored.size(), tiles.size());
  const FieldPictures here = sheet.find(tiles);
  const FieldPictures there = sheet.find(stored.nextBatch(tiles.size()));
  ASSERT_EQ(here.marks.size(), 12U);
  ASSERT_EQ(there.marks.size(), 12U);
  for (std::size_t i = 0; i < here.marks.size(); ++i) {
    EXPECT_EQ(here.marks[i].number, there.marks[i].number);
    EXPECT_EQ(here.marks[i].p_S_mm, there.marks[i].p_S_mm);
    EXPECT_EQ(here.marks[i].covariance, there.marks[i].covariance);
  }
}

TEST(FieldMarks, AFolderThatIsNotWholeSaysWhatIsWrong) {
  const base::TempFolder folder;
  EXPECT_THROW(camera::TileFolder(folder.path()), base::ConfigError);
  static_cast<void>(folder.write(
      "tiles.yaml",
      "version: 1\ntiles:\n  - {file: a.png, p_TV_mm: [0, 0]}\n  - {file: b.png, p_TV_mm: [0]}\n"));
  try {
    const camera::TileFolder tiles(folder.path());
    FAIL() << "must not be read";
  } catch (const base::ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("tiles.yaml:3: tiles[0].file: there is no"));
    EXPECT_THAT(e.what(), HasSubstr("tiles.yaml:4: tiles[1].p_TV_mm"));
  }
  static_cast<void>(folder.write("tiles.yaml", "version: 1\ntiles:\n  - {file: a.png, p_TV_mm: [0, 0]}\n"));
  static_cast<void>(folder.write("a.png", "no picture"));
  camera::TileFolder tiles(folder.path());
  EXPECT_THROW(static_cast<void>(tiles.nextBatch(1)), base::ConfigError);
}

TEST(FieldMarks, EveryPictureOfAFolderThatIsUnfitIsNamed) {
  const base::TempFolder folder;
  MarkedSheet sheet(4, 3);
  const auto tiles = sheet.tiles();
  vision::test::ReadyTiles live(tiles);
  camera::writeTiles(live, folder.path());
  const camera::PictureSize size{tiles[0].image.width, tiles[0].image.height};
  EXPECT_EQ(camera::TileFolder(folder.path(), size).nextBatch(1).size(), 1U);
  const auto toldOf = [&](camera::TileFolder stored) {
    try {
      static_cast<void>(stored.nextBatch(1));
    } catch (const base::ConfigError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(toldOf(camera::TileFolder(folder.path(), camera::PictureSize{size.width_px, 7})),
              AllOf(HasSubstr("tile-0000.png: has"), HasSubstr("x 7"), HasSubstr("\n"),
                    HasSubstr("tile-0001.png: has")));
  static_cast<void>(folder.write("tiles.yaml",
                                 "version: 1\ntiles:\n  - {file: tile-0000.png, p_TV_mm: [0, 0]}\n"
                                 "  - {file: tile-0000.png, p_TV_mm: [9, 0]}\n"));
  try {
    const camera::TileFolder listed(folder.path());
    FAIL() << "must not be read";
  } catch (const base::ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("tiles.yaml:4: tiles[1].file: tile-0000.png is listed twice"));
  }
}

}  // namespace
}  // namespace kerfbench::calibrate
