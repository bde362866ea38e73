// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/base/image.h"
#include "twin/camera/camera.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {

/// A box of pixels [x0, x1) x [y0, y1).
struct PixelBox {
  int x0{}, y0{}, x1{}, y1{};
  [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(x1 - x0); }
  [[nodiscard]] std::size_t area() const { return width() * static_cast<std::size_t>(y1 - y0); }
  [[nodiscard]] bool meets(const PixelBox& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
  [[nodiscard]] PixelBox with(const PixelBox& other) const {
    return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1), std::max(y1, other.y1)};
  }
  [[nodiscard]] PixelBox within(const PixelBox& other) const {
    return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1), std::min(y1, other.y1)};
  }
  [[nodiscard]] PixelWindow window() const { return {x0, y0, x1 - x0, y1 - y0}; }
};

/// Place of the web at one instant.
struct WebPose {
  Eigen::Vector2d p_WS_mm{Eigen::Vector2d::Zero()};
  double angle_rad{};
  double cos{};
  double sin{};
  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector2d& p_S_mm) const {
    return p_WS_mm +
           Eigen::Vector2d(cos * p_S_mm.x() - sin * p_S_mm.y(), sin * p_S_mm.x() + cos * p_S_mm.y());
  }
  [[nodiscard]] Eigen::Vector2d placeOnWeb(const Eigen::Vector2d& p_W_mm) const {
    const Eigen::Vector2d d = p_W_mm - p_WS_mm;
    return {cos * d.x() + sin * d.y(), -sin * d.x() + cos * d.y()};
  }
};

/// Light of one printed mark: a blurred disc, smeared over the places where the web was.
struct MarkImage {
  PixelBox box;
  std::vector<Eigen::Vector2d> p_WM_mm;  ///< Centres during the exposure.
  double radius_mm{};
  double px_per_mm{};
};

/// Light of other print: a blurred rectangle, smeared like the marks.
struct AreaImage {
  PixelBox box;
  struct Place {
    Eigen::Vector2d p_WA_mm{Eigen::Vector2d::Zero()};
    double cos{}, sin{};  ///< Cosine and sine of the rectangle's angle in W.
  };
  std::vector<Place> places;
  Eigen::Vector2d half_mm{Eigen::Vector2d::Zero()};
  double ink{};
  double px_per_mm{};
};

/// Light that glows during one instant: a Gaussian.
struct Blob {
  PixelBox box;
  Eigen::Vector2d centre_px{Eigen::Vector2d::Zero()};
  Eigen::Matrix2d inverse_covariance{Eigen::Matrix2d::Identity()};
  double gray{};
};

/// Contents of an exposure and the pixels that they cover.
struct SpotScene {
  std::vector<WebPose> web;  ///< Instants of equal weight; >= 1.
  std::vector<MarkImage> marks;
  std::vector<AreaImage> areas;
  std::vector<Blob> glow;
  std::vector<Blob> plume;
  /// Boxes around everything but plain board, none of which meets another.
  [[nodiscard]] std::vector<PixelBox> boxes() const;
  /// Box around all of the glow and the plume; empty if the laser was dark.
  [[nodiscard]] PixelBox glowBox() const;
};

/// Works out scenes and draws their light. Immutable.
class SpotStage {
 public:
  SpotStage(const CameraDescription& camera, const PrintLayout& print, double glow_gray_per_w,
            std::uint64_t seed);

  [[nodiscard]] SpotScene sceneOf(const Exposure& exposure) const;
  /// Darkens plain board within `box` (row-major in `light`) by the print. What lies in a pixel does not
  /// depend on the box.
  void addPrint(const SpotScene& scene, const PixelBox& box, std::vector<float>& light) const;
  static void addBlobs(const std::vector<Blob>& blobs, const PixelBox& box, std::vector<float>& light);
  [[nodiscard]] const PlaneProjection& projection() const { return projection_; }

 private:
  /// Share of light that remains `distance` blur sigmas outside of a straight edge: the normal distribution's
  /// tail.
  class BlurredEdge {
   public:
    BlurredEdge();
    [[nodiscard]] float at(double distance) const;

   private:
    std::array<float, 1026> table_{};
  };

  [[nodiscard]] PixelBox boxAround(const Eigen::Vector2d& centre_px, double half_x, double half_y) const;
  /// Box around print of this reach and its blurred edge, and so many pixels more.
  [[nodiscard]] std::optional<PixelBox> boxOnPlane(const Eigen::Vector2d& p_W_mm, double reach_mm,
                                                   double around_px, double* px_per_mm) const;
  [[nodiscard]] bool grained() const { return camera_.texture.grain_gray > 0.0; }
  [[nodiscard]] std::vector<WebPose> webPoses(const Exposure& exposure) const;
  void addMarks(SpotScene& scene, int unit) const;
  void addAreas(SpotScene& scene, int unit) const;
  /// Blobs of light for the glow. cloud_sigma_mm: size of the Gaussian; 0: half the spot's own radius.
  [[nodiscard]] std::vector<Blob> blobs(const Exposure& exposure, double gray_per_w, double cloud_sigma_mm,
                                        const Eigen::Vector2d& offset_mm) const;
  [[nodiscard]] std::vector<Blob> plumeOf(const Exposure& exposure) const;
  void addMark(const MarkImage& mark, const PixelBox& box, std::vector<float>& light) const;
  void addArea(const AreaImage& area, const PixelBox& piece, const PixelBox& box,
               std::vector<float>& light) const;

  CameraDescription camera_;
  PrintLayout print_;
  double glow_gray_per_w_;
  std::uint64_t seed_;
  PlaneProjection projection_;
  Eigen::AlignedBox2d view_W_;
  double mm_per_px_;
  double blur_px_;
  BlurredEdge edge_;
};

/// Points of the plane at the corners, middles and centre of a box whose pixel centres lie at s = (x - x0 +
/// 0.5) / (x1 - x0); nullopt if one sees nothing.
std::optional<PlanePatch::Nodes> nodesOf(const PlaneProjection& projection, const PixelBox& box);

/// Calls visit(piece) for pieces of a box, none larger than `side` pixels in either direction.
template <typename Visit>
void forEachPiece(const PixelBox& box, int side, const Visit& visit) {
  for (int y = box.y0; y < box.y1; y += side) {
    for (int x = box.x0; x < box.x1; x += side)
      visit(PixelBox{x, y, std::min(x + side, box.x1), std::min(y + side, box.y1)});
  }
}

}  // namespace kerfbench::twin
