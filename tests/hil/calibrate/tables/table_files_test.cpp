// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/table_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

namespace fs = std::filesystem;

constexpr std::array<TableFormat, 6> kAll{TableFormat::kCsv,      TableFormat::kCHeader,
                                          TableFormat::kCor1,     TableFormat::kCor2,
                                          TableFormat::kGridText, TableFormat::kNinePoints};

class TableFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("tables_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    options_.cor.units_per_mm = 655.36;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
  TableOptions options_;
  SeededHead head_{8, 50};
  AimGrid grid_{head_.table(evenly(-50, 50, 33), evenly(-50, 50, 33))};
};

TEST_F(TableFiles, EachFormatIsKnownByItsContentAndReadsAsItsLossSays) {
  for (const TableFormat format : kAll) {
    const fs::path path = folder_ / nameOf(format);
    const TableLoss told = writeTable(path, format, grid_, options_);
    const TableLoss found = tableLoss(grid_, readTable(path, options_));
    EXPECT_EQ(told.text(), found.text()) << nameOf(format);
    EXPECT_EQ(tableFormat(nameOf(format)), format);
    EXPECT_EQ(told.not_covered, 0U) << nameOf(format) << "\n" << told.text();
    EXPECT_NEAR(told.covered_share, 1.0, 1e-6) << nameOf(format);
  }
  EXPECT_FALSE(tableFormat("ct5"));
}

TEST_F(TableFiles, LossesAreThoseOfTheFormats) {
  const auto loss = [&](TableFormat format) {
    return writeTable(folder_ / "table", format, grid_, options_);
  };
  EXPECT_EQ(loss(TableFormat::kCsv).anywhere.max_um, 0.0);
  EXPECT_LT(loss(TableFormat::kGridText).nodes.max_um, 1e-9);
  EXPECT_GT(loss(TableFormat::kGridText).mid_cell.max_um, 1.0);
  EXPECT_LT(loss(TableFormat::kCor1).nodes.max_um, 1e-6);
  const double half_a_unit_um = 500 / 655.36 * std::sqrt(2.0);
  EXPECT_LE(loss(TableFormat::kCor2).nodes.max_um, half_a_unit_um);
  EXPECT_GT(loss(TableFormat::kCor2).nodes.max_um, 0.5 * half_a_unit_um);
  // Twice as many nodes leave a quarter of the chords' error, and the units' on top.
  EXPECT_LT(loss(TableFormat::kCor1).mid_cell.max_um, 0.3 * loss(TableFormat::kGridText).mid_cell.max_um);
  EXPECT_GT(loss(TableFormat::kNinePoints).anywhere.max_um, 100.0);
}

TEST_F(TableFiles, WhatCannotBeWrittenLeavesTheOldFileAlone) {
  const fs::path path = folder_ / "table.cor";
  writeTable(path, TableFormat::kCor1, grid_, options_);
  options_.cor.units_per_mm = 600.0;  // The field is larger than the table covers.
  EXPECT_THROW(writeTable(path, TableFormat::kCor1, grid_, options_), std::invalid_argument);
  EXPECT_NO_THROW((void)readTable(path));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(TableFiles, ReadingSaysWhatIsMissing) {
  EXPECT_EQ(faultsOf([&] { (void)readTable("/no/such/table"); }), "/no/such/table: no such file");
  EXPECT_EQ(faultsOf([&] { (void)readTable(folder_); }), folder_.string() + ": is a folder, no regular file");
  std::ofstream(folder_ / "a") << "0 0 0 0\n";
  EXPECT_EQ(faultsOf([&] { (void)readTable(folder_ / "a"); }),
            (folder_ / "a").string() + ": which format this is cannot be told from its content, say it");
}

}  // namespace
}  // namespace kerfbench::calibrate
