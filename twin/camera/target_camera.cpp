// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/target_camera.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <Eigen/LU>

#include "twin/base/image.h"
#include "twin/base/random.h"
#include "twin/camera/gaussian_blur.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr int kTargetBlockPx = 16;
constexpr std::uint64_t kTargetSeed = 0x94b1c36e0d75fa28ULL;

/// A block of pixels [x0, x1) x [y0, y1).
struct Block {
  int x0{}, x1{}, y0{}, y1{};
};

/// Draws the light of one view.
class View {
 public:
  View(const CameraDescription& camera, const TargetPattern& pattern)
      : projection_(camera),
        pattern_(pattern),
        width_(camera.width_px),
        variance_px2_(std::pow(std::max(camera.psf_sigma_px, kPixelSigma), 2)) {}

  void draw(const Block& block, std::vector<float>& light) {
    PlanePatch::Nodes nodes;
    bool whole = true;
    for (std::size_t n = 0; n < nodes.size() && whole; ++n) {
      const std::size_t row = n / 3;
      const Vector2d pixel(block.x0 + 0.5 * static_cast<double>(n % 3) * (block.x1 - block.x0),
                           block.y0 + 0.5 * static_cast<double>(row) * (block.y1 - block.y0));
      const std::optional<Vector2d> point = projection_.planePointOf(pixel);
      if (point) nodes[n] = *point;
      whole = point.has_value();
    }
    // Where the plane ends within the block, every pixel is projected on its own.
    const std::optional<PlanePatch> patch = whole ? std::optional<PlanePatch>(nodes) : std::nullopt;
    const Eigen::Matrix2d middle = whole ? covarianceAt(nodes[4]) : Eigen::Matrix2d::Identity();
    for (int y = block.y0; y < block.y1; ++y) {
      for (int x = block.x0; x < block.x1; ++x) {
        float& pixel = light[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                             static_cast<std::size_t>(x)];
        if (patch) {
          const double s = (x - block.x0) / static_cast<double>(block.x1 - block.x0);
          const double t = (y - block.y0) / static_cast<double>(block.y1 - block.y0);
          pixel = static_cast<float>(pattern_.blurredAt(patch->at(s, t), middle, scratch_));
        } else if (const std::optional<Vector2d> point = projection_.planePointOf(Vector2d(x, y))) {
          pixel = static_cast<float>(pattern_.blurredAt(*point, covarianceAt(*point), scratch_));
        }
      }
    }
  }

 private:
  /// Covariance on the board of one pixel's blur.
  [[nodiscard]] Eigen::Matrix2d covarianceAt(const Vector2d& p_B_mm) const {
    const Eigen::Matrix2d mm_per_px = projection_.jacobianAt(p_B_mm).inverse();
    return variance_px2_ * mm_per_px * mm_per_px.transpose();
  }

  PlaneProjection projection_;
  const TargetPattern& pattern_;
  int width_;
  double variance_px2_;
  TargetPattern::Scratch scratch_;
};

}  // namespace

TargetCamera::TargetCamera(const CameraDescription& camera, const TargetBoard& board, std::uint64_t seed)
    : camera_([&] {
        CameraDescription without_pose = camera;
        without_pose.X_CP = Eigen::Isometry3d::Identity();
        std::string faults = faultsOf(without_pose);
        const std::string more = faultsOf(board);
        if (!more.empty()) faults += (faults.empty() ? "" : "; ") + more;
        if (!faults.empty()) throw std::invalid_argument(faults);
        return without_pose;
      }()),
      pattern_(board),
      shading_(camera_),
      noise_(camera.read_noise, camera.full_well_electrons, camera.bits),
      seed_(seed) {}

GrayImage TargetCamera::render(const Eigen::Isometry3d& X_CB, std::uint64_t view) const {
  CameraDescription posed = camera_;
  posed.X_CP = X_CB;
  const std::string faults = faultsOf(posed);
  if (!faults.empty()) throw std::invalid_argument("TargetCamera::render: " + faults);
  // z of B goes into the paper: seen from the front it points away from the camera.
  if (!(X_CB.linear().col(2).dot(X_CB.translation()) > 0.0)) {
    throw std::invalid_argument("TargetCamera::render: the board shows its back");
  }
  const auto area = static_cast<std::size_t>(camera_.width_px) * static_cast<std::size_t>(camera_.height_px);
  std::vector<float> light(area, static_cast<float>(pattern_.around()));
  View drawing(posed, pattern_);
  for (int y = 0; y < camera_.height_px; y += kTargetBlockPx) {
    for (int x = 0; x < camera_.width_px; x += kTargetBlockPx) {
      drawing.draw({x, std::min(x + kTargetBlockPx, camera_.width_px), y,
                    std::min(y + kTargetBlockPx, camera_.height_px)},
                   light);
    }
  }
  const PixelWindow whole{0, 0, camera_.width_px, camera_.height_px};
  shading_.shadeByLamp(whole, light);
  shading_.shadeByLens(whole, light);
  shading_.addHotPixels(light);
  return noise_.picture(light, camera_.width_px, camera_.height_px, CounterRandom(seed_ ^ kTargetSeed, view));
}

}  // namespace kerfbench::twin
