// SPDX-License-Identifier: Apache-2.0
// Drawn pictures, compared with what the scene must look like and with the ray-traced picture of the same
// scene.
#include "hil/scene/drawing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <vector>

#include "hil/base/png_codec.h"
#include "hil/scene/picture.h"
#include "hil/scene/shading.h"
#include "tests/hil/scene/example_scene.h"

namespace kerfbench::scene {
namespace {

using Eigen::Vector3d;

constexpr int kDrawnWidth = 200;
constexpr int kDrawnHeight = 130;

using Pixel = std::array<int, 3>;

Pixel pixelOf(const base::PngSamples& picture, const Eigen::Vector2d& p) {
  const auto at = 3 * static_cast<std::size_t>(std::lround(p.y()) * picture.width_px + std::lround(p.x()));
  return {picture.bytes.at(at), picture.bytes.at(at + 1), picture.bytes.at(at + 2)};
}

base::PngSamples decodedPicture(const twin::Scene& scene, SceneView view, PictureQuality quality) {
  PictureOptions options;
  options.quality = quality;
  options.view = view;
  options.width_px = kDrawnWidth;
  options.height_px = kDrawnHeight;
  options.inset = false;
  return base::decodePng(renderPng(scene, options), base::PngColours::kRgb).value();
}

TEST(Drawing, TheBeamGlowsAtItsSpotAndOnlyWhenItIsOn) {
  const twin::Scene lit = sceneWithBeam(true);
  const Viewpoint view = viewpointOf(lit, SceneView::kOverall, kDrawnWidth, kDrawnHeight);
  const Eigen::Vector2d spot = *view.project(lit.beam.back().p_W_mm);
  const Pixel on = pixelOf(drawScene(lit, view), spot);
  const Pixel off = pixelOf(drawScene(sceneWithBeam(false), view), spot);
  EXPECT_GT(on[0], 230) << "red";
  EXPECT_GT(on[0], on[2] + 60) << "orange, not white";
  EXPECT_LT(off[0], off[2] + 60) << "board";
}

TEST(Drawing, ABurntLineIsDarkOnTheBrightBoard) {
  const twin::Scene scene = sceneWithBeam(false);
  const Viewpoint view = viewpointOf(scene, SceneView::kSheet, kDrawnWidth, kDrawnHeight);
  const base::PngSamples picture = decodedPicture(scene, SceneView::kSheet, PictureQuality::kDrawn);
  const Pixel line = pixelOf(picture, *view.project({-20, -40, 0}));
  const Pixel board = pixelOf(picture, *view.project({-20, -30, 0}));
  EXPECT_GT(board[1], 150);
  EXPECT_LT(line[1], board[1] - 60);
}

TEST(Drawing, ABurntLineBehindAPartIsNotSeen) {
  twin::Scene scene = sceneWithBeam(false);
  const Viewpoint view = viewpointOf(scene, SceneView::kOverall, kDrawnWidth, kDrawnHeight);
  const Vector3d place(-20, -40, 0);
  const base::PngSamples open = drawScene(scene, view);
  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();
  X_WP.translation() = place + 60.0 * (view.place_mm() - place).normalized();
  scene.parts.push_back({"cover", twin::Material::kLight, X_WP, twin::Box{{40, 40, 40}, 0.0}});
  const base::PngSamples covered = drawScene(scene, view);
  const Eigen::Vector2d at = *view.project(place);
  EXPECT_NE(pixelOf(open, at), pixelOf(covered, at));
  // The cover's face is as bright there as it is beside the line.
  EXPECT_EQ(pixelOf(covered, at), pixelOf(covered, at + Eigen::Vector2d(0, 1)));
}

// POV-Ray traces the same scene independently: parts, lamps and colours must agree. Shadows, reflections and
// edges may differ a little.
TEST(Drawing, AgreesWithTheRayTracedPicture) {
  for (const bool on : {false, true}) {
    for (const SceneView view : {SceneView::kOverall, SceneView::kSheet, SceneView::kHead}) {
      const twin::Scene scene = sceneWithBeam(on);
      const base::PngSamples traced = decodedPicture(scene, view, PictureQuality::kTraced);
      const base::PngSamples picture = decodedPicture(scene, view, PictureQuality::kDrawn);
      ASSERT_EQ(picture.bytes.size(), traced.bytes.size());
      std::vector<int> differences;
      for (std::size_t i = 0; i < traced.bytes.size(); ++i)
        differences.push_back(
            std::abs(static_cast<int>(traced.bytes[i]) - static_cast<int>(picture.bytes[i])));
      std::ranges::sort(differences);
      EXPECT_LE(differences[differences.size() / 2], 3) << static_cast<int>(view) << on;
      EXPECT_LE(differences[differences.size() * 9 / 10], 25) << static_cast<int>(view) << on;
    }
  }
}

TEST(Drawing, NeedsNoOtherProgramAndGivesTheSameBytesEveryTime) {
  PictureOptions options;
  options.quality = PictureQuality::kDrawn;
  options.width_px = kDrawnWidth;
  options.height_px = kDrawnHeight;
  options.povray = "/nonexistent/povray";
  const std::vector<std::uint8_t> png = renderPng(sceneWithBeam(true), options);
  EXPECT_EQ(renderPng(sceneWithBeam(true), options), png);
  options.inset = false;
  EXPECT_NE(renderPng(sceneWithBeam(true), options), png);
}

TEST(Drawing, AHeightThatIsNoWholeNumberOfBandsIsDrawnToItsEnd) {
  const twin::Scene scene = sceneWithBeam(false);
  for (const int height : {64, 65, 79, 80}) {
    const Viewpoint view = viewpointOf(scene, SceneView::kOverall, 100, height);
    const base::PngSamples picture = drawScene(scene, view);
    ASSERT_EQ(picture.bytes.size(), static_cast<std::size_t>(3 * 100 * height));
    EXPECT_GT(pixelOf(picture, {5, height - 1})[1], 60) << "the floor";
  }
}

// A plate 100 mm above a plane, both lit by the key lamp alone.
class Shadows : public testing::Test {
 protected:
  Shadows() {
    Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();
    X_WP.translation() = Vector3d(0, 0, 100);
    scene_.parts.push_back({"plate", twin::Material::kDark, X_WP, twin::Box{{200, 200, 4}, 0.0}});
    scene_.overall.extend(Vector3d(-200, -200, 0));
    scene_.overall.extend(Vector3d(200, 200, 200));
  }
  // On the plane, where the middle of the lamp is seen past this place of the plate.
  [[nodiscard]] Vector3d shadowOf(double x, double y) const {
    const Vector3d plate(x, y, 98);
    const Vector3d way = plate - lighting().key_mm;
    return plate - plate.z() / way.z() * way;
  }
  [[nodiscard]] Lighting lighting() const {
    return lightingOf(scene_, viewpointOf(scene_, SceneView::kOverall, kDrawnWidth, kDrawnHeight));
  }
  twin::Scene scene_;
};

TEST_F(Shadows, AreDarkInTheMiddleSoftAtTheEdgeAndNowhereElse) {
  const ShadowMap shadows(meshOf(scene_), lighting());
  const auto lit = [&](double x, double y) { return shadows.lit(shadowOf(x, y), Vector3d::UnitZ()); };
  EXPECT_EQ(lit(0, 0), 0.0);
  EXPECT_EQ(lit(50, -50), 0.0);
  EXPECT_NEAR(lit(100, 0), 0.5, 0.25);
  EXPECT_EQ(lit(130, 0), 1.0);
  EXPECT_EQ(lit(0, 5000), 1.0);
}

TEST_F(Shadows, APlateDoesNotShadeItsOwnTop) {
  const ShadowMap shadows(meshOf(scene_), lighting());
  for (double x = -99; x < 100; x += 6) {
    for (double y = -99; y < 100; y += 6)
      EXPECT_EQ(shadows.lit({x, y, 102}, Vector3d::UnitZ()), 1.0) << x << ", " << y;
  }
}

}  // namespace
}  // namespace kerfbench::scene
