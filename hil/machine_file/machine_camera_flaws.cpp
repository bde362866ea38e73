// SPDX-License-Identifier: Apache-2.0
#include "hil/machine_file/machine_sections.h"

namespace kerfbench::machine_file {
namespace {

twin::BoardTexture readTexture(base::YamlReader texture) {
  twin::BoardTexture result;
  result.grain_gray = texture.number("grain_gray", {.min = 0, .max = 40, .fallback = 0.0});
  result.grain_length_mm =
      texture.number("grain_length_mm", {.min = 0.01, .max = 10, .fallback = result.grain_length_mm});
  result.glow_share = kPercent * texture.number("glow_percent", {.min = 0, .max = 50, .fallback = 0.0});
  result.glow_length_mm =
      texture.number("glow_length_mm", {.min = 0.01, .max = 10, .fallback = result.glow_length_mm});
  return result;
}

twin::EdgeRoughness readRoughness(base::YamlReader roughness) {
  twin::EdgeRoughness result;
  result.rms_mm = roughness.number("rms_mm", {.min = 0, .max = 0.1, .fallback = 0.0});
  result.length_mm = roughness.number("length_mm", {.min = 0.01, .max = 10, .fallback = result.length_mm});
  return result;
}

twin::BlurFoot readFoot(base::YamlReader foot) {
  twin::BlurFoot result;
  result.share = kPercent * foot.number("percent", {.min = 0, .max = 50, .fallback = 0.0});
  result.sigma_px = foot.number("sigma_px", {.min = 0.5, .max = 4, .fallback = result.sigma_px});
  return result;
}

twin::Plume readPlume(base::YamlReader plume) {
  twin::Plume result;
  result.share = kPercent * plume.number("percent", {.min = 0, .max = 100, .fallback = 0.0});
  const auto offset = plume.numbers("offset_mm", 2, {.min = -50, .max = 50, .fallback = 0.0});
  result.offset_mm = {offset[0], offset[1]};
  result.sigma_mm = plume.number("sigma_mm", {.min = 0.01, .max = 20, .fallback = result.sigma_mm});
  result.flicker = kPercent * plume.number("flicker_percent", {.min = 0, .max = 200, .fallback = 0.0});
  result.wander_mm = plume.number("wander_mm", {.min = 0, .max = 20, .fallback = 0.0});
  return result;
}

twin::UnevenLight readLight(base::YamlReader light) {
  twin::UnevenLight result;
  result.vignette = kPercent * light.number("vignette_percent", {.min = 0, .max = 90, .fallback = 0.0});
  const auto gradient = light.numbers("gradient_percent", 2, {.min = -100, .max = 100, .fallback = 0.0});
  result.gradient_x = kPercent * gradient[0];
  result.gradient_y = kPercent * gradient[1];
  return result;
}

twin::HotPixels readHotPixels(base::YamlReader hot) {
  twin::HotPixels result;
  result.share = kPercent * hot.number("percent", {.min = 0, .max = 1, .fallback = 0.0});
  result.gray = hot.number("gray", {.min = 0, .max = 255, .fallback = result.gray});
  result.seed = static_cast<std::uint64_t>(hot.integer("seed", {.min = 0, .max = 9e15, .fallback = 1.0}));
  return result;
}

constexpr std::size_t kMostBursts = 1000;

std::vector<twin::FrameLink::Burst> readBursts(base::YamlReader& link, const char* key) {
  std::vector<twin::FrameLink::Burst> result;
  auto bursts = link.list(key);
  if (bursts.size() > kMostBursts) {
    link.fault(key, "has more than 1000 entries");
    return result;
  }
  for (base::YamlReader& burst : bursts) {
    result.push_back(
        {static_cast<std::uint64_t>(burst.integer("first", {.min = 0, .max = 9e15})),
         static_cast<std::uint64_t>(burst.integer("count", {.min = 1, .max = 1e6, .fallback = 1.0}))});
  }
  return result;
}

twin::FrameLink readLink(base::YamlReader link) {
  twin::FrameLink result;
  result.drop_share = kPercent * link.number("drop_percent", {.min = 0, .max = 100, .fallback = 0.0});
  result.stamp_jitter_s = kMicro * link.number("stamp_jitter_us", {.min = 0, .max = 1e6, .fallback = 0.0});
  result.late_share = kPercent * link.number("late_percent", {.min = 0, .max = 100, .fallback = 0.0});
  result.late_s = kMilli * link.number("late_ms", {.min = 0, .max = 1e4, .fallback = 0.0});
  result.lost = readBursts(link, "lost");
  result.late = readBursts(link, "late");
  if (!result.late.empty() && result.late_s == 0.0) link.fault("late", "says no late_ms to be late by");
  return result;
}

}  // namespace

void readCameraFlaws(base::YamlReader& camera, bool timed, twin::CameraDescription& result) {
  result.bits = static_cast<int>(camera.integer("bits", {.min = 8, .max = 12, .fallback = 8.0}));
  result.board_seed =
      static_cast<std::uint64_t>(camera.integer("board_seed", {.min = 0, .max = 9e15, .fallback = 1.0}));
  result.texture = readTexture(camera.section("texture"));
  result.light = readLight(camera.section("light"));
  result.hot = readHotPixels(camera.section("hot_pixels"));
  if (timed) {
    result.plume = readPlume(camera.section("plume"));
    result.link = readLink(camera.section("link"));
  } else {
    result.roughness = readRoughness(camera.section("roughness"));
    result.foot = readFoot(camera.section("foot"));
  }
}

}  // namespace kerfbench::machine_file
