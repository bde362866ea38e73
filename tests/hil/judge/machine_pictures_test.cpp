// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/machine_pictures.h"

#include <gtest/gtest.h>

#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/base/png_codec.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/machine_file/machine_file.h"
#include "tests/hil/base/temp_folder.h"
#include "twin/cutter/twin.h"

namespace kerfbench::judge {
namespace {

/// A machine that was filmed at rest, and a renderer that fails at the picture with that number.
class MachinePictures : public testing::Test {
 protected:
  MachinePictures() {
    test_case.machine = machine_file::readMachine(base::fixture("machines/two-mirror.yaml"));
    test_case.dieline = std::make_shared<const dieline::Dieline>(
        dieline::readDieline(base::fixture("dielines/label-60x40.dxf"), dieline::defaultLayerProfile()));
    constexpr TickRate kTicks{1, 16'000'000};
    twin::Twin twin(test_case.machine, {}, kTicks);
    film_.add(twin);
  }

  std::vector<report::ReportPicture> written(const Renderer& render) {
    return writeMachinePictures(film_, test_case, test_case.machine, folder_.path(), trouble_, render);
  }
  template <typename Error>
  std::vector<report::ReportPicture> failingAt(int number, const Error& error) {
    int count = 0;
    return written([&](const twin::Scene&, const scene::PictureOptions&) {
      if (++count == number) throw error;
      return std::vector<std::uint8_t>{1, 2, 3};
    });
  }

  scenario::Case test_case;
  run::MachineFilm film_{100.0};
  std::string trouble_{"an older one"};
  base::TempFolder folder_;
};

TEST_F(MachinePictures, AreInTheFolderAsTheReportHasThem) {
  const auto pictures = written(scene::renderPng);
  EXPECT_EQ(trouble_, "");
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_EQ(pictures[0].file, "machine.png");
  EXPECT_EQ(pictures[1].file, "board.png");
  EXPECT_NE(pictures[0].png, pictures[1].png);
  EXPECT_EQ(folder_.entries(), 2);
  for (const report::ReportPicture& picture : pictures) {
    EXPECT_EQ(base::contentOf(folder_.path() / picture.file), picture.png);
    const std::vector<std::uint8_t> bytes(picture.png.begin(), picture.png.end());
    const auto samples = base::decodePng(bytes, base::PngColours::kRgb);
    ASSERT_TRUE(samples);
    EXPECT_EQ(samples->width_px, 640);
    EXPECT_EQ(samples->height_px, 400);
  }
}

TEST_F(MachinePictures, AreDrawnWithoutAnotherProgram) {
  (void)written([](const twin::Scene&, const scene::PictureOptions& options) {
    EXPECT_EQ(options.quality, scene::PictureQuality::kDrawn);
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(MachinePictures, ThatFailAreToldAndStopNothing) {
  EXPECT_TRUE(failingAt(1, scene::PictureError("no lamp")).empty());
  EXPECT_EQ(trouble_, "no picture of the machine: no lamp");
  EXPECT_EQ(folder_.entries(), 0);
  EXPECT_TRUE(failingAt(1, std::bad_alloc()).empty());
  EXPECT_TRUE(failingAt(1, std::out_of_range("beyond")).empty());
  EXPECT_EQ(trouble_, "no picture of the machine: beyond");
}

TEST_F(MachinePictures, ThatWereMadeBeforeOneFailedAreKept) {
  const auto pictures = failingAt(2, std::runtime_error("no board"));
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_EQ(pictures[0].file, "machine.png");
  EXPECT_EQ(trouble_, "no picture of the machine: no board");
  EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(MachinePictures, OfNothingFilmedAreNoneAndNoTrouble) {
  film_ = run::MachineFilm(100.0);
  EXPECT_TRUE(written(scene::renderPng).empty());
  EXPECT_EQ(trouble_, "");
  EXPECT_EQ(folder_.entries(), 0);
}

}  // namespace
}  // namespace kerfbench::judge
