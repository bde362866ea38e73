// SPDX-License-Identifier: Apache-2.0
// Pictures by POV-Ray, which is one of packages.txt: without it these tests fail, and are not skipped.
#include "hil/scene/picture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "hil/base/png_codec.h"
#include "hil/scene/pov_text.h"
#include "tests/hil/scene/example_scene.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 200;
constexpr int kHeight = 130;

PictureOptions small(SceneView view = SceneView::kOverall) {
  PictureOptions options;
  options.view = view;
  options.width_px = kWidth;
  options.height_px = kHeight;
  options.inset = false;
  return options;
}

// Picture that is rendered once: POV-Ray alone takes a third of a second to start.
const std::vector<std::uint8_t>& litPicture() {
  static const std::vector<std::uint8_t> png = renderPng(sceneWithBeam(true), small());
  return png;
}

cv::Mat decoded(const std::vector<std::uint8_t>& png) {
  std::optional<base::PngSamples> samples = base::decodePng(png, base::PngColours::kRgb);
  if (!samples) return {};
  return cv::Mat(samples->height_px, samples->width_px, CV_8UC3, samples->bytes.data()).clone();
}

// Red, green and blue at a place.
cv::Vec3b at(const cv::Mat& picture, const Eigen::Vector2d& p) {
  return picture.at<cv::Vec3b>(static_cast<int>(std::lround(p.y())), static_cast<int>(std::lround(p.x())));
}

// A scripted program in place of POV-Ray.
class FakeProgram {
 public:
  explicit FakeProgram(const std::string& script) {
    std::string name = (fs::temp_directory_path() / "kerfbench-fake-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    folder_ = name;
    std::ofstream(path()) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(path(), fs::perms::owner_all);
  }
  ~FakeProgram() { fs::remove_all(folder_); }
  FakeProgram(const FakeProgram&) = delete;
  FakeProgram& operator=(const FakeProgram&) = delete;
  [[nodiscard]] fs::path path() const { return folder_ / "povray"; }

 private:
  fs::path folder_;
};

std::string errorOf(const PictureOptions& options) {
  try {
    (void)renderPng(sceneWithBeam(true), options);
  } catch (const PictureError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Picture, HasTheSizeAskedForAndShowsSomething) {
  const cv::Mat picture = decoded(litPicture());
  ASSERT_FALSE(picture.empty());
  EXPECT_EQ(picture.cols, kWidth);
  EXPECT_EQ(picture.rows, kHeight);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(picture, mean, deviation);
  EXPECT_GT(deviation[0], 15.0);
  EXPECT_GT(mean[0], 40.0);
  EXPECT_LT(mean[0], 220.0);
}

TEST(Picture, TheBeamGlowsAtItsSpotAndOnlyWhenItIsOn) {
  const twin::Scene lit = sceneWithBeam(true);
  for (const SceneView which : {SceneView::kOverall, SceneView::kSheet}) {
    const auto spot = viewpointOf(lit, which, kWidth, kHeight).project(lit.beam.back().p_W_mm);
    ASSERT_TRUE(spot);
    const cv::Vec3b on = at(decoded(renderPng(lit, small(which))), *spot);
    const cv::Vec3b off = at(decoded(renderPng(sceneWithBeam(false), small(which))), *spot);
    EXPECT_GT(on[0], 230) << "red";
    EXPECT_GT(on[0], on[2] + 60) << "orange, not white";
    EXPECT_LT(off[0], off[2] + 60) << "board";
  }
}

TEST(Picture, ABurntLineIsDarkOnTheBrightBoard) {
  const twin::Scene scene = sceneWithBeam(false);
  const Viewpoint view = viewpointOf(scene, SceneView::kSheet, kWidth, kHeight);
  const cv::Mat picture = decoded(renderPng(scene, small(SceneView::kSheet)));
  const cv::Vec3b line = at(picture, *view.project({-20, -40, 0}));
  const cv::Vec3b board = at(picture, *view.project({-20, -30, 0}));
  EXPECT_GT(board[1], 150);
  EXPECT_LT(line[1], board[1] - 60);
}

// A contour that begins behind the eye of a close-up gave a pixel of negative size in an earlier version: all
// points were kept, and the splitting of the line ran out of stack.
TEST(Picture, ABurntSpiralThatBeginsBehindTheEyeIsThinnedWithoutRecursion) {
  const twin::Scene scene = sceneWithBeam(false);
  const Viewpoint view = viewpointOf(scene, SceneView::kHead, kWidth, kHeight);
  twin::Scene spiral = scene;
  spiral.burnt.emplace_back();
  constexpr int kPoints = 10000;
  for (int i = 0; i < kPoints; ++i) {
    const double share = static_cast<double>(i) / kPoints;
    const double phi_rad = 10.0 * share;
    spiral.burnt.back().emplace_back(2000.0 * (1.0 - share) * std::cos(phi_rad),
                                     2000.0 * (1.0 - share) * std::sin(phi_rad), 0.0);
  }
  const auto behind = [&](const Eigen::Vector3d& p) { return view.pixel_mm(p) < 0; };
  ASSERT_TRUE(std::any_of(spiral.burnt.back().begin(), spiral.burnt.back().end(), behind));
  ASSERT_FALSE(std::all_of(spiral.burnt.back().begin(), spiral.burnt.back().end(), behind));
  EXPECT_LT(povText(spiral, view).size(), povText(scene, view).size() + 50U * kPoints);
  for (Eigen::Vector3d& p : spiral.burnt.back()) p = 2.0 * view.place_mm() - p;
  std::erase_if(spiral.burnt.back(), [&](const Eigen::Vector3d& p) { return !behind(p); });
  ASSERT_FALSE(spiral.burnt.back().empty());
  EXPECT_EQ(povText(spiral, view), povText(scene, view));
}

TEST(Picture, IsTheSameBytesEveryTime) {
  EXPECT_EQ(renderPng(sceneWithBeam(true), small()), litPicture());
  PictureOptions options = small();
  options.inset = true;
  const auto with_inset = renderPng(sceneWithBeam(true), options);
  EXPECT_EQ(renderPng(sceneWithBeam(true), options), with_inset);
  EXPECT_NE(with_inset, litPicture());
}

TEST(Picture, CarriesNoTimeAndNoHost) {
  const auto& png = litPicture();
  const std::string bytes(png.begin(), png.end());
  for (const char* chunk : {"tEXt", "tIME", "iTXt", "POV-Ray"})
    EXPECT_EQ(bytes.find(chunk), std::string::npos) << chunk;
}

TEST(Picture, NeitherHomeNorSettingsOfTheUserTakePart) {
  const auto& expected = litPicture();
  const std::string home = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "";
  ASSERT_EQ(::setenv("HOME", "/nonexistent", 1), 0);
  ASSERT_EQ(::setenv("POVINI", "/nonexistent/povray.ini", 1), 0);
  const auto without = renderPng(sceneWithBeam(true), small());
  ::setenv("HOME", home.c_str(), 1);
  ::unsetenv("POVINI");
  EXPECT_EQ(without, expected);
}

TEST(Picture, SaysWhatToInstallWhenTheProgramIsMissing) {
  PictureOptions options = small();
  options.povray = "/nonexistent/povray";
  EXPECT_FALSE(povrayFound(options.povray));
  const std::string error = errorOf(options);
  EXPECT_NE(error.find("/nonexistent/povray"), std::string::npos) << error;
  EXPECT_NE(error.find("apt-get install povray"), std::string::npos) << error;
}

TEST(Picture, PassesOnWhyTheProgramFailed) {
  const FakeProgram fake("echo 'Rendering' >&2; echo 'Parse Error: no camera' >&2; exit 3");
  PictureOptions options = small();
  options.povray = fake.path();
  const std::string error = errorOf(options);
  EXPECT_NE(error.find("exit status 3"), std::string::npos) << error;
  EXPECT_NE(error.find("Parse Error: no camera"), std::string::npos) << error;
  EXPECT_EQ(error.find("Rendering"), std::string::npos) << error;
}

TEST(Picture, AProgramThatWritesNothingOrRubbishIsAnError) {
  const FakeProgram silent("exit 0");
  PictureOptions options = small();
  options.povray = silent.path();
  EXPECT_NE(errorOf(options).find("wrote no picture"), std::string::npos);
  const FakeProgram rubbish("echo rubbish > picture.png");
  options.povray = rubbish.path();
  EXPECT_NE(errorOf(options).find("cannot be read"), std::string::npos);
}

TEST(Picture, AProgramThatNeverEndsIsStopped) {
  const FakeProgram endless("exec tail -f /dev/null");
  PovrayOptions options;
  options.program = endless.path();
  options.patience_s = 0.05;
  EXPECT_THROW((void)runPovray("", options), PictureError);
}

TEST(Picture, LeavesNothingInTheTemporaryFolder) {
  const auto left = [] {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(fs::temp_directory_path())) {
      count += entry.path().filename().string().starts_with("kerfbench-picture-" + std::to_string(::getpid()))
                   ? 1
                   : 0;
    }
    return count;
  };
  (void)litPicture();
  const FakeProgram fake("exit 1");
  PictureOptions options = small();
  options.povray = fake.path();
  (void)errorOf(options);
  EXPECT_EQ(left(), 0);
}

TEST(Picture, RefusesSizesOutOfRange) {
  PictureOptions options = small();
  options.width_px = 20;
  EXPECT_THROW((void)renderPng(sceneWithBeam(true), options), PictureError);
  options.width_px = 10000;
  EXPECT_THROW((void)renderPng(sceneWithBeam(true), options), PictureError);
}

}  // namespace
}  // namespace kerfbench::scene
