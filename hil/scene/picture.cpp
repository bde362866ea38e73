// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "hil/base/png_codec.h"
#include "hil/scene/annotate.h"
#include "hil/scene/drawing.h"
#include "hil/scene/fixed_picture.h"
#include "hil/scene/pov_text.h"

namespace kerfbench::scene {
namespace {

constexpr double kInsetShare = 0.26;  // Share of the picture's width.
// The machine keeps clear of the inset: it may reach under it, since it is lower there.
constexpr double kInsetFree = 0.17;

// The pixels alone: nothing else of the file that POV-Ray wrote (its comments and times) goes on.
base::PngSamples trace(const twin::Scene& scene, const Viewpoint& view, const std::filesystem::path& povray) {
  PovrayOptions options;
  options.program = povray;
  options.width_px = view.width_px();
  options.height_px = view.height_px();
  std::optional<base::PngSamples> samples =
      base::decodePng(runPovray(povText(scene, view), options), base::PngColours::kRgb);
  if (!samples) throw PictureError("POV-Ray's picture cannot be read");
  return std::move(*samples);
}

base::PngSamples render(const twin::Scene& scene, const Viewpoint& view, const PictureOptions& options) {
  return options.quality == PictureQuality::kDrawn ? drawScene(scene, view)
                                                   : trace(scene, view, options.povray);
}

std::vector<Eigen::Vector3d> cornersOf(const Eigen::AlignedBox3d& box) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  return corners;
}

// In the part's own frame.
Eigen::AlignedBox3d extentOf(const twin::ScenePart& part) {
  using Eigen::Vector3d;
  struct Extent {
    Eigen::AlignedBox3d operator()(const twin::Box& b) const { return {-0.5 * b.size_mm, 0.5 * b.size_mm}; }
    Eigen::AlignedBox3d operator()(const twin::Cylinder& c) const {
      const Vector3d half(c.radius_mm, c.radius_mm, 0.5 * c.length_mm);
      return {-half, half};
    }
    Eigen::AlignedBox3d operator()(const twin::Disc& d) const {
      return {Vector3d(-d.radius_mm.x(), -d.radius_mm.y(), -d.thickness_mm),
              Vector3d(d.radius_mm.x(), d.radius_mm.y(), 0)};
    }
    Eigen::AlignedBox3d operator()(const twin::Cone& c) const {
      return {Vector3d(-c.radius_mm, -c.radius_mm, 0), Vector3d(c.radius_mm, c.radius_mm, c.length_mm)};
    }
  };
  return std::visit(Extent{}, part.shape);
}

// What hangs over the board would hide it; of the beam the spot is left.
twin::Scene openedFromAbove(twin::Scene scene) {
  constexpr double kOverBoard_mm = 1.0;
  std::erase_if(scene.parts, [](const twin::ScenePart& part) {
    double low_mm = 1e300;
    for (const Eigen::Vector3d& corner : cornersOf(extentOf(part)))
      low_mm = std::min(low_mm, (part.X_WP * corner).z());
    return low_mm > kOverBoard_mm;
  });
  if (scene.beam.size() > 1) scene.beam.erase(scene.beam.begin(), scene.beam.end() - 1);
  return scene;
}

}  // namespace

Viewpoint viewpointOf(const twin::Scene& scene, SceneView view, int width_px, int height_px, bool inset) {
  switch (view) {
    case SceneView::kHead:
      return Viewpoint::around(cornersOf(scene.head), scene.head_view, width_px, height_px, 1.0);
    case SceneView::kSheet:
      return Viewpoint::around(cornersOf(scene.sheet.isEmpty() ? scene.overall : scene.sheet),
                               {0.0, 0.08, -1.0}, width_px, height_px, 0.9);
    case SceneView::kOverall:
      break;
  }
  std::vector<Eigen::Vector3d> points;
  for (const twin::ScenePart& part : scene.parts) {
    for (const Eigen::Vector3d& corner : cornersOf(extentOf(part))) points.push_back(part.X_WP * corner);
  }
  return Viewpoint::around(points, {-0.55, 1.0, -0.62}, width_px, height_px, 0.94, inset ? kInsetFree : 0.0);
}

bool hasInset(const twin::Scene& scene, const PictureOptions& options) {
  return options.inset && options.view == SceneView::kOverall && !scene.head.isEmpty();
}

std::vector<std::uint8_t> renderPng(const twin::Scene& scene, const PictureOptions& options) {
  constexpr int kSmallest_px = 64;
  constexpr int kLargest_px = 8192;
  if (std::min(options.width_px, options.height_px) < kSmallest_px ||
      std::max(options.width_px, options.height_px) > kLargest_px) {
    throw PictureError(fmt::format("a picture of {} x {} pixels cannot be made: {} to {} each way",
                                   options.width_px, options.height_px, kSmallest_px, kLargest_px));
  }
  return renderPngFrom(
      scene, options,
      viewpointOf(scene, options.view, options.width_px, options.height_px, hasInset(scene, options)));
}

std::vector<std::uint8_t> renderPngFrom(const twin::Scene& scene, const PictureOptions& options,
                                        const Viewpoint& view) {
  base::PngSamples picture =
      render(options.view == SceneView::kSheet ? openedFromAbove(scene) : scene, view, options);
  std::optional<Inset> inset;
  if (hasInset(scene, options)) {
    const int side_px = static_cast<int>(kInsetShare * std::min(options.width_px, 2 * options.height_px));
    const Viewpoint head = viewpointOf(scene, SceneView::kHead, side_px, side_px);
    inset = Inset{render(scene, head, options), head, scene.head_labels};
  }
  const std::string caption = options.caption.empty()
                                  ? fmt::format("{}  t = {:.4f} s", scene.machine, scene.time_s)
                                  : options.caption;
  std::vector<twin::SceneLabel> labels;
  if (options.view == SceneView::kOverall) labels = scene.labels;
  if (options.view == SceneView::kHead) labels = scene.head_labels;
  return annotate(std::move(picture), labels, view, caption, std::move(inset));
}

}  // namespace kerfbench::scene
