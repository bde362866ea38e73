// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/spot_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <Eigen/LU>

#include "twin/base/multiversion.h"
#include "twin/base/random.h"
#include "twin/base/wide_math.h"
#include "twin/camera/disc_painter.h"
#include "twin/camera/gaussian_blur.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr double kEdgeSigmas = 4.0;
// Large areas of print bend with the lens. Grain is painted where something is drawn: around marks and spot
// as far as anybody looks at the board there.
constexpr double kAroundArea_px = 10.0;
constexpr double kGrainAroundMark_px = 10.0;
constexpr double kGrainAroundSpot_px = 12.0;
constexpr double kFaintGray = 0.02;
/// Most travel of the web for which one pose stands: a smear of 0.1 px has a variance of 0.0008 px², a
/// hundredth of what the pixel's own area adds to the blur.
constexpr double kGroupTravel_px = 0.1;
constexpr std::uint64_t kPlumeSeed = 0x2d94b8f1c6e7035aULL;

/// Distance that `place` moves during the part of the exposure for which sample i stands.
template <typename Place>
Vector2d travelDuring(const std::vector<ExposureSample>& samples, std::size_t i, Place place) {
  const std::size_t last = samples.size() - 1;
  const std::size_t before = i == 0 ? 0 : i - 1;
  const std::size_t after = std::min(i + 1, last);
  if (before == after) return Vector2d::Zero();
  return (place(samples[after]) - place(samples[before])) / static_cast<double>(after - before);
}

int partsFor(double travel_mm, double step_mm) {
  return std::clamp(static_cast<int>(std::ceil(travel_mm / step_mm)), 1, 1000);
}

WebPose poseAt(const Vector2d& p_WS_mm, double angle_rad) {
  return {p_WS_mm, angle_rad, std::cos(angle_rad), std::sin(angle_rad)};
}

WebPose meanPose(std::span<const ExposureSample> samples) {
  const auto count = static_cast<double>(samples.size());
  Vector2d p_WS_mm = Vector2d::Zero();
  double angle_rad = 0.0;
  for (const ExposureSample& sample : samples) {
    p_WS_mm += sample.p_WS_mm / count;
    angle_rad += sample.angle_rad / count;
  }
  return poseAt(p_WS_mm, angle_rad);
}

/// The most samples of which at least `groups` equal groups can be made.
std::size_t samplesInGroup(std::size_t samples, std::size_t groups) {
  std::size_t each = std::max<std::size_t>(samples / groups, 1);
  while (samples % each != 0) --each;
  return each;
}

void mergeOverlapping(std::vector<PixelBox>& boxes) {
  for (std::size_t i = 0; i < boxes.size();) {
    bool merged = false;
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      if (!boxes[i].meets(boxes[j])) continue;
      boxes[i] = boxes[i].with(boxes[j]);
      boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j));
      merged = true;
      break;
    }
    // The grown box may meet an earlier one.
    i = merged ? 0 : i + 1;
  }
}

/// A Gaussian along a row of pixels: gray * exp(-square / 2), and square of pixel i is first + i (slope + i
/// curve).
struct BellOfRow {
  float first, slope, curve, gray;

  KERFBENCH_WIDE void add(int count, float* line) const {
    constexpr float kFar = 60.0F;
    for (int i = 0; i < count; ++i) {
      const auto x = static_cast<float>(i);
      const float square = first + x * (slope + x * curve);
      const float near = square < kFar ? square : kFar;
      line[i] += near < kFar ? gray * wideExp(-0.5F * near) : 0.0F;
    }
  }
};

float* lineOf(std::vector<float>& light, const PixelBox& box, int y) {
  return light.data() + static_cast<std::ptrdiff_t>(y - box.y0) * (box.x1 - box.x0) - box.x0;
}

}  // namespace

PixelBox SpotScene::glowBox() const {
  PixelBox all;
  for (const std::vector<Blob>* blobs : {&glow, &plume}) {
    for (const Blob& blob : *blobs) all = all.empty() ? blob.box : all.with(blob.box);
  }
  return all;
}

std::vector<PixelBox> SpotScene::boxes() const {
  std::vector<PixelBox> all;
  for (const MarkImage& mark : marks) all.push_back(mark.box);
  for (const AreaImage& area : areas) all.push_back(area.box);
  if (const PixelBox spot = glowBox(); !spot.empty()) all.push_back(spot);
  mergeOverlapping(all);
  return all;
}

SpotStage::BlurredEdge::BlurredEdge() {
  constexpr double kPerSigma = 128.0;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double distance = (static_cast<double>(i) / kPerSigma) - kEdgeSigmas;
    table_[i] = static_cast<float>(0.5 * std::erfc(distance / std::numbers::sqrt2));
  }
}

float SpotStage::BlurredEdge::at(double distance) const {
  constexpr double kPerSigma = 128.0;
  if (distance <= -kEdgeSigmas) return 1.0F;
  if (distance >= kEdgeSigmas) return 0.0F;
  const double place = (distance + kEdgeSigmas) * kPerSigma;
  const auto i = static_cast<std::size_t>(place);
  const auto t = static_cast<float>(place - static_cast<double>(i));
  return table_[i] + t * (table_[i + 1] - table_[i]);
}

SpotStage::SpotStage(const CameraDescription& camera, const PrintLayout& print, double glow_gray_per_w,
                     std::uint64_t seed)
    : camera_(camera),
      print_(print),
      glow_gray_per_w_(glow_gray_per_w),
      seed_(seed),
      projection_(camera),
      view_W_(fieldOf(projection_, camera.width_px, camera.height_px).circumscribed),
      mm_per_px_(1.0 / std::sqrt(std::abs(projection_.jacobianAt(view_W_.center()).determinant()))),
      blur_px_(std::max(camera.psf_sigma_px, kPixelSigma)) {}

SpotScene SpotStage::sceneOf(const Exposure& exposure) const {
  SpotScene scene;
  scene.web = webPoses(exposure);
  for (int unit = 0; unit < print_.units; ++unit) {
    addMarks(scene, unit);
    addAreas(scene, unit);
  }
  scene.glow = blobs(exposure, glow_gray_per_w_, 0.0, Vector2d::Zero());
  scene.plume = plumeOf(exposure);
  return scene;
}

PixelBox SpotStage::boxAround(const Vector2d& centre_px, double half_x, double half_y) const {
  const auto clip = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  return {clip(std::floor(centre_px.x() - half_x), camera_.width_px),
          clip(std::floor(centre_px.y() - half_y), camera_.height_px),
          clip(std::ceil(centre_px.x() + half_x) + 1.0, camera_.width_px),
          clip(std::ceil(centre_px.y() + half_y) + 1.0, camera_.height_px)};
}

std::vector<WebPose> SpotStage::webPoses(const Exposure& exposure) const {
  const auto place = [](const ExposureSample& sample) { return sample.p_WS_mm; };
  const auto& samples = exposure.samples;
  double travel_mm = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) travel_mm += travelDuring(samples, i, place).norm();
  std::vector<WebPose> poses;
  // Slow: neighbouring samples, as many in each group, are one pose, at their mean.
  const auto groups = static_cast<std::size_t>(partsFor(travel_mm, kGroupTravel_px * mm_per_px_));
  if (const std::size_t each = samplesInGroup(samples.size(), groups); each > 1) {
    for (auto group = samples.begin(); group != samples.end(); group += static_cast<std::ptrdiff_t>(each))
      poses.push_back(meanPose({group, each}));
    return poses;
  }
  // Every sample gets the same number of parts: each stands for the same time.
  const int parts = partsFor(travel_mm / static_cast<double>(samples.size()), 0.5 * mm_per_px_);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector2d travel = travelDuring(samples, i, place);
    for (int part = 0; part < parts; ++part) {
      poses.push_back(
          poseAt(samples[i].p_WS_mm + travel * ((part + 0.5) / parts - 0.5), samples[i].angle_rad));
    }
  }
  return poses;
}

std::optional<PixelBox> SpotStage::boxOnPlane(const Vector2d& p_W_mm, double reach_mm, double around_px,
                                              double* px_per_mm) const {
  const std::optional<Vector2d> centre_px = projection_.pixelOf(p_W_mm);
  if (!centre_px) return std::nullopt;
  const Eigen::Matrix2d J = projection_.jacobianAt(p_W_mm);
  *px_per_mm = std::sqrt(std::abs(J.determinant()));
  const double pad_px = kEdgeSigmas * blur_px_ + around_px;
  const PixelBox box = boxAround(*centre_px, 1.05 * reach_mm * J.row(0).norm() + pad_px,
                                 1.05 * reach_mm * J.row(1).norm() + pad_px);
  return box.empty() ? std::nullopt : std::optional<PixelBox>(box);
}

void SpotStage::addMarks(SpotScene& scene, int unit) const {
  const WebPose& middle = scene.web[scene.web.size() / 2];
  for (const RegistrationMark& mark : print_.marks) {
    const Vector2d p_SM_mm = mark.p_SM_mm - Vector2d(unit * print_.pitch_mm, 0.0);
    const Vector2d p_WM_mm = middle.place(p_SM_mm);
    if (view_W_.exteriorDistance(p_WM_mm) > 2.0 * mark.diameter_mm) continue;
    MarkImage image;
    image.radius_mm = 0.5 * mark.diameter_mm;
    double reach_mm = image.radius_mm;
    for (const WebPose& pose : scene.web) {
      image.p_WM_mm.push_back(pose.place(p_SM_mm));
      reach_mm = std::max(reach_mm, image.radius_mm + (image.p_WM_mm.back() - p_WM_mm).norm());
    }
    const double around_px = grained() ? kGrainAroundMark_px : 1.0;
    const std::optional<PixelBox> box = boxOnPlane(p_WM_mm, reach_mm, around_px, &image.px_per_mm);
    if (!box) continue;
    image.box = *box;
    scene.marks.push_back(std::move(image));
  }
}

void SpotStage::addAreas(SpotScene& scene, int unit) const {
  const WebPose& middle = scene.web[scene.web.size() / 2];
  for (const PrintedArea& print : print_.areas) {
    const Vector2d p_SA_mm = print.p_SA_mm - Vector2d(unit * print_.pitch_mm, 0.0);
    const Vector2d p_WA_mm = middle.place(p_SA_mm);
    AreaImage image;
    image.half_mm = 0.5 * print.size_mm;
    image.ink = print.ink;
    // An area may be larger than the picture and its centre far out of sight, where the projection fails.
    Eigen::AlignedBox2d bounds_W;
    for (const WebPose& pose : scene.web) {
      const double angle_rad = pose.angle_rad + print.angle_rad;
      image.places.push_back({pose.place(p_SA_mm), std::cos(angle_rad), std::sin(angle_rad)});
      const Vector2d reach(std::abs(image.places.back().cos) * image.half_mm.x() +
                               std::abs(image.places.back().sin) * image.half_mm.y(),
                           std::abs(image.places.back().sin) * image.half_mm.x() +
                               std::abs(image.places.back().cos) * image.half_mm.y());
      bounds_W.extend(image.places.back().p_WA_mm - reach);
      bounds_W.extend(image.places.back().p_WA_mm + reach);
    }
    const Eigen::AlignedBox2d seen = bounds_W.intersection(view_W_);
    if (seen.isEmpty() || !p_WA_mm.allFinite()) continue;
    const std::optional<PixelBox> box =
        boxOnPlane(seen.center(), 0.5 * seen.diagonal().norm(), kAroundArea_px, &image.px_per_mm);
    if (!box) continue;
    image.box = *box;
    scene.areas.push_back(std::move(image));
  }
}

std::vector<Blob> SpotStage::blobs(const Exposure& exposure, double gray_per_w, double cloud_sigma_mm,
                                   const Vector2d& offset_mm) const {
  std::vector<Blob> found;
  const double pad_px = grained() ? kGrainAroundSpot_px : 0.0;
  const auto& samples = exposure.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ExposureSample& sample = samples[i];
    const double gray = gray_per_w * sample.power_w;
    if (!(gray > kFaintGray)) continue;
    const Vector2d travel = travelDuring(samples, i, [](const ExposureSample& s) { return s.p_WQ_mm; });
    const double sigma_mm = cloud_sigma_mm > 0.0 ? cloud_sigma_mm : 0.5 * sample.radius_mm;
    const int parts = partsFor(travel.norm(), 0.8 * std::hypot(sigma_mm, blur_px_ * mm_per_px_));
    const double reach = std::sqrt(2.0 * std::log(gray / kFaintGray));
    for (int part = 0; part < parts; ++part) {
      const Vector2d p_WQ_mm = sample.p_WQ_mm + offset_mm + travel * ((part + 0.5) / parts - 0.5);
      const std::optional<Vector2d> centre_px = projection_.pixelOf(p_WQ_mm);
      if (!centre_px) continue;
      const Eigen::Matrix2d J = projection_.jacobianAt(p_WQ_mm);
      const Eigen::Matrix2d covariance =
          sigma_mm * sigma_mm * J * J.transpose() + blur_px_ * blur_px_ * Eigen::Matrix2d::Identity();
      const PixelBox box = boxAround(*centre_px, reach * std::sqrt(covariance(0, 0)) + pad_px,
                                     reach * std::sqrt(covariance(1, 1)) + pad_px);
      if (box.empty()) continue;
      found.push_back(
          {box, *centre_px, covariance.inverse(), gray / (static_cast<double>(samples.size()) * parts)});
    }
  }
  return found;
}

std::vector<Blob> SpotStage::plumeOf(const Exposure& exposure) const {
  const Plume& plume = camera_.plume;
  if (!(plume.share > 0.0)) return {};
  const CounterRandom random(seed_ ^ kPlumeSeed, exposure.sequence);
  const double share = plume.share * std::max(0.0, 1.0 + plume.flicker * random.normal(0));
  const Vector2d wander_mm = plume.wander_mm * Vector2d(random.normal(1), random.normal(2));
  return blobs(exposure, share * glow_gray_per_w_, plume.sigma_mm, plume.offset_mm + wander_mm);
}

void SpotStage::addPrint(const SpotScene& scene, const PixelBox& box, std::vector<float>& light) const {
  for (const MarkImage& mark : scene.marks) {
    if (mark.box.meets(box)) addMark(mark, box, light);
  }
  for (const AreaImage& area : scene.areas) {
    if (!area.box.meets(box)) continue;
    forEachPiece(area.box, 32, [&](const PixelBox& piece) {
      if (piece.meets(box)) addArea(area, piece, box, light);
    });
  }
}

void SpotStage::addMark(const MarkImage& mark, const PixelBox& box, std::vector<float>& light) const {
  const PixelBox& own = mark.box;
  PlanePatch::Nodes nodes;
  for (std::size_t n = 0; n < 9; ++n) {
    const std::size_t column = n % 3;
    const std::size_t row = n / 3;
    const Vector2d pixel(own.x0 + 0.5 * static_cast<double>(column) * (own.x1 - own.x0),
                         own.y0 + 0.5 * static_cast<double>(row) * (own.y1 - own.y0));
    const std::optional<Vector2d> point = projection_.planePointOf(pixel);
    if (!point) return;
    nodes[n] = *point;
  }
  const PlanePatch patch(nodes);
  const DiscPainter painter(mark, patch, blur_px_, kMarkGray - camera_.board_gray);
  painter.add(box, light);
}

void SpotStage::addArea(const AreaImage& area, const PixelBox& piece, const PixelBox& box,
                        std::vector<float>& light) const {
  const std::optional<PlanePatch::Nodes> nodes = nodesOf(projection_, piece);
  if (!nodes) return;
  const PlanePatch patch(*nodes);
  const double sigmas_per_mm = area.px_per_mm / blur_px_;
  const auto share = static_cast<float>(area.ink / static_cast<double>(area.places.size()));
  // Share of a blurred strip of half width `half` at a distance from its middle.
  const auto within = [&](double distance, double half) {
    return edge_.at((distance - half) * sigmas_per_mm) - edge_.at((distance + half) * sigmas_per_mm);
  };
  const PixelBox drawn = piece.within(box);
  for (int y = drawn.y0; y < drawn.y1; ++y) {
    const double t = (y - piece.y0 + 0.5) / (piece.y1 - piece.y0);
    float* const line = lineOf(light, box, y);
    for (int x = drawn.x0; x < drawn.x1; ++x) {
      const Vector2d p_W_mm = patch.at((x - piece.x0 + 0.5) / (piece.x1 - piece.x0), t);
      float covered = 0.0F;
      for (const AreaImage::Place& place : area.places) {
        const Vector2d d = p_W_mm - place.p_WA_mm;
        covered += within(place.cos * d.x() + place.sin * d.y(), area.half_mm.x()) *
                   within(-place.sin * d.x() + place.cos * d.y(), area.half_mm.y());
      }
      line[x] += share * covered * (static_cast<float>(kMarkGray) - line[x]);
    }
  }
}

void SpotStage::addBlobs(const std::vector<Blob>& blobs, const PixelBox& box, std::vector<float>& light) {
  for (const Blob& blob : blobs) {
    const double xx = blob.inverse_covariance(0, 0);
    const double xy = blob.inverse_covariance(0, 1);
    const double yy = blob.inverse_covariance(1, 1);
    const PixelBox drawn = blob.box.within(box);
    const double dx = drawn.x0 - blob.centre_px.x();
    for (int y = drawn.y0; y < drawn.y1; ++y) {
      const double dy = y - blob.centre_px.y();
      const BellOfRow bell{
          static_cast<float>(dx * dx * xx + 2.0 * dx * dy * xy + dy * dy * yy),
          static_cast<float>(2.0 * (dx * xx + dy * xy)),
          static_cast<float>(xx),
          static_cast<float>(blob.gray),
      };
      bell.add(drawn.x1 - drawn.x0, lineOf(light, box, y) + drawn.x0);
    }
  }
}

std::optional<PlanePatch::Nodes> nodesOf(const PlaneProjection& projection, const PixelBox& box) {
  PlanePatch::Nodes nodes;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const std::size_t row = n / 3;
    const Vector2d pixel(box.x0 - 0.5 + 0.5 * static_cast<double>(n % 3) * (box.x1 - box.x0),
                         box.y0 - 0.5 + 0.5 * static_cast<double>(row) * (box.y1 - box.y0));
    const std::optional<Vector2d> point = projection.planePointOf(pixel);
    if (!point) return std::nullopt;
    nodes[n] = *point;
  }
  return nodes;
}

}  // namespace kerfbench::twin
