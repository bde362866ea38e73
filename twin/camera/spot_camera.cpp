// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "twin/base/image.h"
#include "twin/base/random.h"
#include "twin/camera/board_field.h"
#include "twin/camera/camera.h"
#include "twin/camera/picture_shading.h"
#include "twin/camera/plane_grid.h"
#include "twin/camera/sensor_noise.h"
#include "twin/camera/spot_scene.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kStripPixels = std::size_t{1} << 18U;
constexpr std::uint64_t kStripStream = ~std::uint64_t{0} - 3;  // Stream above every sequence number.
constexpr std::uint64_t kRowSeed = 0x5f3c1d2e9b8a7061ULL;
constexpr std::uint64_t kLinkSeed = 0xb05a7e1946c3d82fULL;
constexpr std::uint64_t kSpotGrainStream = 1;
constexpr std::uint64_t kGlowStream = 2;
constexpr int kPiecePx = 32;

/// Plain board: a long strip of noise; each row of a frame takes a piece of it.
template <typename Level>
class NoiseStrip {
 public:
  NoiseStrip(const SensorNoise& noise, const CameraDescription& camera, std::uint64_t seed)
      : width_(static_cast<std::size_t>(camera.width_px)), seed_(seed ^ kRowSeed) {
    strip_.resize(kStripPixels + width_);
    const std::vector<float> light(4096, static_cast<float>(camera.board_gray));
    const CounterRandom random(seed, kStripStream);
    for (std::size_t begin = 0; begin < strip_.size(); begin += light.size()) {
      const std::size_t count = std::min(light.size(), strip_.size() - begin);
      noise.expose(std::span(light).first(count), random, begin, strip_.data() + begin);
    }
  }
  [[nodiscard]] std::vector<Level> frame(std::uint64_t sequence, int height) const {
    const CounterRandom random(seed_, sequence);
    std::vector<Level> pixels;
    pixels.reserve(width_ * static_cast<std::size_t>(height));
    std::uint64_t bits = 0;
    for (int y = 0; y < height; ++y, bits >>= 32U) {
      // Two rows share 64 random bits.
      if (y % 2 == 0) bits = random.bits(static_cast<std::uint64_t>(y));
      const Level* const piece = strip_.data() + bits % kStripPixels;
      pixels.insert(pixels.end(), piece, piece + width_);
    }
    return pixels;
  }

 private:
  std::size_t width_;
  std::uint64_t seed_;
  std::vector<Level> strip_;
};

void checkExposure(const Exposure& exposure) {
  bool fine = !exposure.samples.empty() && std::isfinite(exposure.start_s);
  for (const ExposureSample& sample : exposure.samples) {
    fine = fine && sample.p_WQ_mm.allFinite() && sample.p_WS_mm.allFinite() &&
           std::isfinite(sample.angle_rad) && std::isfinite(sample.power_w) && sample.power_w >= 0.0 &&
           std::isfinite(sample.radius_mm) && (sample.power_w == 0.0 || sample.radius_mm > 0.0);
  }
  if (!fine)
    throw std::invalid_argument(
        "SpotCamera::render: an exposure without samples or with values out of range");
}

PlanePatch::Nodes onWeb(const PlanePatch::Nodes& p_W_mm, const WebPose& pose) {
  PlanePatch::Nodes nodes;
  std::transform(p_W_mm.begin(), p_W_mm.end(), nodes.begin(),
                 [&](const Vector2d& point) { return pose.placeOnWeb(point); });
  return nodes;
}

}  // namespace

struct SpotCamera::Model {
  CameraDescription camera;
  std::uint64_t seed;
  SpotStage stage;
  SensorNoise noise;
  PictureShading shading;
  std::optional<BoardField> grain;
  std::optional<BoardField> glow_texture;
  std::optional<PlaneGrid> grid;  ///< Grid for grain all over the picture.
  std::optional<NoiseStrip<std::uint8_t>> strip8;
  std::optional<NoiseStrip<std::uint16_t>> strip16;

  Model(const CameraDescription& camera_, const PrintLayout& print, double glow, std::uint64_t seed_);
  /// True if no part of a frame is plain board.
  [[nodiscard]] bool drawsAll() const {
    return !shading.even() || (grain && camera.texture.grain_everywhere);
  }
  /// Adds grain to `light`. `box` is the whole picture if all of it is rendered.
  void addGrain(const SpotScene& scene, const PixelBox& box, std::vector<float>& light) const;
  void addHotPixels(const PixelBox& box, std::vector<float>& light) const;
  void addGlow(const SpotScene& scene, const PixelBox& box, std::vector<float>& light) const;
  [[nodiscard]] std::vector<float> lightOf(const SpotScene& scene, const PixelBox& box) const;
  template <typename Level>
  [[nodiscard]] std::vector<Level> expose(const Exposure& exposure,
                                          const std::optional<NoiseStrip<Level>>& strip) const;
};

SpotCamera::Model::Model(const CameraDescription& camera_, const PrintLayout& print, double glow,
                         std::uint64_t seed_)
    : camera(camera_),
      seed(seed_),
      stage(camera_, print, glow, seed_),
      noise(camera_.read_noise, camera_.full_well_electrons, camera_.bits),
      shading(camera_) {
  const BoardTexture& texture = camera.texture;
  if (texture.grain_gray > 0.0) {
    grain.emplace(camera.board_seed, kSpotGrainStream, texture.grain_length_mm);
    if (drawsAll()) grid.emplace(stage.projection(), camera.width_px, camera.height_px, kPiecePx);
  }
  if (texture.glow_share > 0.0) glow_texture.emplace(camera.board_seed, kGlowStream, texture.glow_length_mm);
  if (drawsAll()) return;
  if (camera.bits == 8) {
    strip8.emplace(noise, camera, seed);
  } else {
    strip16.emplace(noise, camera, seed);
  }
}

void SpotCamera::Model::addGrain(const SpotScene& scene, const PixelBox& box,
                                 std::vector<float>& light) const {
  FieldPainter painter(*grain);
  const auto scale = static_cast<float>(camera.texture.grain_gray / camera.board_gray /
                                        static_cast<double>(scene.web.size()));
  std::vector<float> share;
  const auto add = [&](const PixelBox& piece, const PlanePatch::Nodes& p_W_mm) {
    share.assign(piece.area(), 1.0F);
    for (const WebPose& pose : scene.web)
      painter.add(onWeb(p_W_mm, pose), piece.x1 - piece.x0, piece.y1 - piece.y0, scale, share);
    const float* from = share.data();
    for (int y = piece.y0; y < piece.y1; ++y, from += piece.width()) {
      float* const line = light.data() + static_cast<std::size_t>(y - box.y0) * box.width() +
                          static_cast<std::size_t>(piece.x0 - box.x0);
      for (std::size_t x = 0; x < piece.width(); ++x) line[x] *= from[x];
    }
  };
  if (!grid) {
    forEachPiece(box, kPiecePx, [&](const PixelBox& piece) {
      if (const auto nodes = nodesOf(stage.projection(), piece)) add(piece, *nodes);
    });
    return;
  }
  for (std::size_t by = 0; by < grid->rows(); ++by) {
    for (std::size_t bx = 0; bx < grid->columns(); ++bx) {
      const PlaneGrid::Block block = grid->block(bx, by);
      add({block.x0, block.y0, block.x1, block.y1}, grid->nodes(bx, by));
    }
  }
}

void SpotCamera::Model::addGlow(const SpotScene& scene, const PixelBox& box,
                                std::vector<float>& light) const {
  if (!glow_texture) {
    SpotStage::addBlobs(scene.glow, box, light);
  } else if (const PixelBox spot = scene.glowBox(); spot.meets(box)) {
    std::vector<float> glow(spot.area(), 0.0F);
    SpotStage::addBlobs(scene.glow, spot, glow);
    FieldPainter painter(*glow_texture);
    const auto scale = static_cast<float>(camera.texture.glow_share / static_cast<double>(scene.web.size()));
    std::vector<float> share;
    forEachPiece(spot, kPiecePx, [&](const PixelBox& piece) {
      const std::optional<PlanePatch::Nodes> nodes = nodesOf(stage.projection(), piece);
      if (!nodes) return;
      share.assign(piece.area(), 1.0F);
      for (const WebPose& pose : scene.web)
        painter.add(onWeb(*nodes, pose), piece.x1 - piece.x0, piece.y1 - piece.y0, scale, share);
      const float* from = share.data();
      for (int y = piece.y0; y < piece.y1; ++y) {
        for (int x = piece.x0; x < piece.x1; ++x) {
          const std::size_t own =
              static_cast<std::size_t>(y - spot.y0) * spot.width() + static_cast<std::size_t>(x - spot.x0);
          light[static_cast<std::size_t>(y - box.y0) * box.width() + static_cast<std::size_t>(x - box.x0)] +=
              glow[own] * std::max(*from++, 0.0F);
        }
      }
    });
  }
  SpotStage::addBlobs(scene.plume, box, light);
}

void SpotCamera::Model::addHotPixels(const PixelBox& box, std::vector<float>& light) const {
  for (const PictureShading::HotPixel& pixel : shading.hotPixels()) {
    if (pixel.x < box.x0 || pixel.x >= box.x1 || pixel.y < box.y0 || pixel.y >= box.y1) continue;
    light[static_cast<std::size_t>(pixel.y - box.y0) * box.width() +
          static_cast<std::size_t>(pixel.x - box.x0)] += pixel.gray;
  }
}

std::vector<float> SpotCamera::Model::lightOf(const SpotScene& scene, const PixelBox& box) const {
  std::vector<float> light(box.area(), static_cast<float>(camera.board_gray));
  stage.addPrint(scene, box, light);
  if (grain) addGrain(scene, box, light);
  if (!shading.even()) shading.shadeByLamp(light);
  addGlow(scene, box, light);
  if (!shading.even()) shading.shadeByLens(light);
  addHotPixels(box, light);
  return light;
}

template <typename Level>
std::vector<Level> SpotCamera::Model::expose(const Exposure& exposure,
                                             const std::optional<NoiseStrip<Level>>& strip) const {
  const SpotScene scene = stage.sceneOf(exposure);
  std::vector<PixelBox> boxes{{0, 0, camera.width_px, camera.height_px}};
  std::vector<Level> pixels;
  if (strip) {
    boxes = scene.boxes();
    pixels = strip->frame(exposure.sequence, camera.height_px);
  } else {
    pixels.resize(boxes.front().area());
  }
  const CounterRandom random(seed, exposure.sequence);
  if (strip) {
    // Hot pixels in a box are added again when the box is rendered.
    for (const PictureShading::HotPixel& pixel : shading.hotPixels()) {
      const std::size_t place =
          static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(camera.width_px) +
          static_cast<std::size_t>(pixel.x);
      const float light = static_cast<float>(camera.board_gray) + pixel.gray;
      noise.expose(std::span(&light, 1), random, place, pixels.data() + place);
    }
  }
  for (const PixelBox& box : boxes) {
    const std::vector<float> light = lightOf(scene, box);
    for (int y = box.y0; y < box.y1; ++y) {
      const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width_px) +
                                static_cast<std::size_t>(box.x0);
      noise.expose(std::span(light).subspan(static_cast<std::size_t>(y - box.y0) * box.width(), box.width()),
                   random, first, pixels.data() + first);
    }
  }
  return pixels;
}

SpotCamera::SpotCamera(const CameraDescription& camera, const PrintLayout& print, double glow_gray_per_w,
                       std::uint64_t seed) {
  std::string faults = faultsOf(camera);
  const auto add = [&faults](const std::string& more) {
    if (!more.empty()) faults += (faults.empty() ? "" : "; ") + more;
  };
  add(faultsOf(print));
  // The condition also refuses NaN.
  if (!(camera.exposure_s > 0.0 && camera.exposure_s <= camera.frame_period_s))
    add("exposure_s must be in (0, frame_period_s]");
  if (!(glow_gray_per_w >= 0.0 && std::isfinite(glow_gray_per_w))) add("glow_gray_per_w must be >= 0");
  if (!faults.empty()) throw std::invalid_argument(faults);
  model_ = std::make_shared<const Model>(camera, print, glow_gray_per_w, seed);
}

const CameraDescription& SpotCamera::description() const { return model_->camera; }

FrameFate SpotCamera::fateOf(std::uint64_t sequence) const {
  const FrameLink& link = model_->camera.link;
  const CounterRandom random(model_->seed ^ kLinkSeed, sequence);
  const auto inAny = [sequence](const std::vector<FrameLink::Burst>& bursts) {
    return std::any_of(bursts.begin(), bursts.end(),
                       [sequence](const FrameLink::Burst& burst) { return burst.has(sequence); });
  };
  FrameFate fate;
  fate.dropped = random.uniform(0) < link.drop_share || inAny(link.lost) ||
                 std::find(link.dropped.begin(), link.dropped.end(), sequence) != link.dropped.end();
  if (link.stamp_jitter_s > 0.0) fate.stamp_error_s = link.stamp_jitter_s * random.normal(1);
  if (random.uniform(4) < link.late_share || inAny(link.late)) fate.stamp_error_s += link.late_s;
  return fate;
}

Frame SpotCamera::render(const Exposure& exposure) const {
  checkExposure(exposure);
  const Model& model = *model_;
  Frame frame;
  frame.sequence = exposure.sequence;
  frame.start_s = exposure.start_s;
  frame.exposure_s = model.camera.exposure_s;
  if (model.camera.bits == 8) {
    frame.image.width = model.camera.width_px;
    frame.image.height = model.camera.height_px;
    frame.image.pixels = model.expose(exposure, model.strip8);
  } else {
    frame.image = GrayImage::ofLevels(model.camera.width_px, model.camera.height_px, model.camera.bits,
                                      model.expose(exposure, model.strip16));
  }
  return frame;
}

}  // namespace kerfbench::twin
