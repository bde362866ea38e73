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
      : seed_(seed ^ kRowSeed) {
    strip_.resize(kStripPixels + static_cast<std::size_t>(camera.width_px));
    const std::vector<float> light(4096, static_cast<float>(camera.board_gray));
    const CounterRandom random(seed, kStripStream);
    for (std::size_t begin = 0; begin < strip_.size(); begin += light.size()) {
      const std::size_t count = std::min(light.size(), strip_.size() - begin);
      noise.expose(std::span(light).first(count), random, begin, strip_.data() + begin);
    }
  }
  [[nodiscard]] std::vector<Level> window(std::uint64_t sequence, const PixelBox& box) const {
    const CounterRandom random(seed_, sequence);
    std::vector<Level> pixels;
    pixels.reserve(box.area());
    for (int y = box.y0; y < box.y1; ++y) {
      // Two rows share 64 random bits.
      const std::uint64_t bits =
          random.bits(static_cast<std::uint64_t>(y - y % 2)) >> (y % 2 == 0 ? 0U : 32U);
      const Level* const piece = strip_.data() + bits % kStripPixels + box.x0;
      pixels.insert(pixels.end(), piece, piece + box.width());
    }
    return pixels;
  }

 private:
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
  /// Adds grain to `light`. Of a picture that is all rendered, `box` is made of whole blocks of its grid.
  void addGrain(const SpotScene& scene, const PixelBox& box, std::vector<float>& light) const;
  void addHotPixels(const PixelBox& box, std::vector<float>& light) const;
  void addGlow(const SpotScene& scene, const PixelBox& box, std::vector<float>& light) const;
  [[nodiscard]] std::vector<float> lightOf(const SpotScene& scene, const PixelBox& box) const;
  /// Boxes to render so that a window shows what it would show in the whole picture. Grain is painted piece
  /// by piece from a box's corner, so its boxes are never cut.
  [[nodiscard]] std::vector<PixelBox> boxesFor(const SpotScene& scene, const PixelBox& window) const;
  template <typename Level>
  [[nodiscard]] std::vector<Level> expose(std::uint64_t sequence, const SpotScene& scene,
                                          const PixelBox& window,
                                          const std::optional<NoiseStrip<Level>>& strip) const;
  [[nodiscard]] GrayImage picture(std::uint64_t sequence, const SpotScene& scene,
                                  const PixelBox& window) const;
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
      const PixelBox piece{block.x0, block.y0, block.x1, block.y1};
      if (piece.meets(box)) add(piece, grid->nodes(bx, by));
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
        for (int x = piece.x0; x < piece.x1; ++x, ++from) {
          if (x < box.x0 || x >= box.x1 || y < box.y0 || y >= box.y1) continue;
          const std::size_t own =
              static_cast<std::size_t>(y - spot.y0) * spot.width() + static_cast<std::size_t>(x - spot.x0);
          light[static_cast<std::size_t>(y - box.y0) * box.width() + static_cast<std::size_t>(x - box.x0)] +=
              glow[own] * std::max(*from, 0.0F);
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
  if (!shading.even()) shading.shadeByLamp(box.window(), light);
  addGlow(scene, box, light);
  if (!shading.even()) shading.shadeByLens(box.window(), light);
  addHotPixels(box, light);
  return light;
}

std::vector<PixelBox> SpotCamera::Model::boxesFor(const SpotScene& scene, const PixelBox& window) const {
  if (drawsAll()) {
    if (!grid) return {window};
    PixelBox blocks = window;
    for (const int edge : grid->edgesX()) {
      if (edge <= window.x0) blocks.x0 = edge;
      if (edge >= window.x1) {
        blocks.x1 = edge;
        break;
      }
    }
    for (const int edge : grid->edgesY()) {
      if (edge <= window.y0) blocks.y0 = edge;
      if (edge >= window.y1) {
        blocks.y1 = edge;
        break;
      }
    }
    return {blocks};
  }
  std::vector<PixelBox> boxes;
  for (const PixelBox& box : scene.boxes()) {
    if (box.meets(window)) boxes.push_back(grain ? box : box.within(window));
  }
  return boxes;
}

template <typename Level>
std::vector<Level> SpotCamera::Model::expose(std::uint64_t sequence, const SpotScene& scene,
                                             const PixelBox& window,
                                             const std::optional<NoiseStrip<Level>>& strip) const {
  std::vector<Level> pixels = strip ? strip->window(sequence, window) : std::vector<Level>(window.area());
  const CounterRandom random(seed, sequence);
  // Noise is drawn by the pixel's place in the whole picture.
  const auto draw = [&](std::span<const float> light, int x, int y) {
    const std::size_t place =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width_px) + static_cast<std::size_t>(x);
    const std::size_t own =
        static_cast<std::size_t>(y - window.y0) * window.width() + static_cast<std::size_t>(x - window.x0);
    noise.expose(light, random, place, pixels.data() + own);
  };
  if (strip) {
    // Hot pixels in a box are added again when the box is rendered.
    for (const PictureShading::HotPixel& pixel : shading.hotPixels()) {
      if (!PixelBox{pixel.x, pixel.y, pixel.x + 1, pixel.y + 1}.meets(window)) continue;
      const float light = static_cast<float>(camera.board_gray) + pixel.gray;
      draw(std::span(&light, 1), pixel.x, pixel.y);
    }
  }
  for (const PixelBox& box : boxesFor(scene, window)) {
    const std::vector<float> light = lightOf(scene, box);
    const PixelBox part = box.within(window);
    for (int y = part.y0; y < part.y1; ++y) {
      const std::size_t first =
          static_cast<std::size_t>(y - box.y0) * box.width() + static_cast<std::size_t>(part.x0 - box.x0);
      draw(std::span(light).subspan(first, part.width()), part.x0, y);
    }
  }
  return pixels;
}

GrayImage SpotCamera::Model::picture(std::uint64_t sequence, const SpotScene& scene,
                                     const PixelBox& window) const {
  const PixelWindow size = window.window();
  GrayImage image;
  if (camera.bits == 8) {
    image.width = size.width;
    image.height = size.height;
    image.pixels = expose(sequence, scene, window, strip8);
  } else {
    image =
        GrayImage::ofLevels(size.width, size.height, camera.bits, expose(sequence, scene, window, strip16));
  }
  image.left = size.left;
  image.top = size.top;
  return image;
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
  const CameraDescription& camera = model_->camera;
  const PixelWindow whole{0, 0, camera.width_px, camera.height_px};
  Frame frame = render(exposure, {&whole, 1});
  frame.image = std::move(frame.windows.front());
  frame.windows.clear();
  return frame;
}

Frame SpotCamera::render(const Exposure& exposure, std::span<const PixelWindow> windows) const {
  checkExposure(exposure);
  const CameraDescription& camera = model_->camera;
  Frame frame;
  frame.sequence = exposure.sequence;
  frame.start_s = exposure.start_s;
  frame.exposure_s = camera.exposure_s;
  const SpotScene scene = model_->stage.sceneOf(exposure);
  for (const PixelWindow& window : windows) {
    const PixelWindow seen = window.within({0, 0, camera.width_px, camera.height_px});
    if (seen.empty()) {
      frame.windows.emplace_back();
      continue;
    }
    frame.windows.push_back(model_->picture(
        exposure.sequence, scene, {seen.left, seen.top, seen.left + seen.width, seen.top + seen.height}));
  }
  return frame;
}

}  // namespace kerfbench::twin
