// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/world.h"

#include <array>

#include <fmt/format.h>

#include "twin/base/random.h"

namespace kerfbench::gauge {
namespace {

constexpr std::uint64_t kWorldStream = 0x776f726c64ULL;
constexpr std::uint64_t kLeanStream = 0x6c65616eULL;

enum Draw : std::uint64_t {
  kThickness,
  kThicknessOff,
  kTransmission,
  kLaw,
  kWalls,
  kScorched,
  kScorch,
  kScorchX,
  kScorchY,
  kGrained,
  kGrain,
  kRadius,
  kFoot,
  kFootSize,
  kCorner,
  kRough,
  kMarks  ///< Two for each mark, from here on.
};

}  // namespace

World toldWorld(const twin::BoardDescription& board, const twin::CameraDescription& camera) {
  World world;
  world.board = board;
  world.told_thickness_mm = board.thickness_mm;
  world.foot = camera.foot;
  world.texture = camera.texture;
  world.open_gray = camera.open_gray;
  world.roughness = camera.roughness;
  world.print = gaugeArtefact(world.corner).print;
  return world;
}

World otherWorld(const twin::BoardDescription& board, const twin::CameraDescription& camera,
                 std::uint64_t seed) {
  const CounterRandom random(seed, kWorldStream);
  const auto between = [&](Draw draw, double low, double high) {
    return low + (high - low) * random.uniform(draw);
  };
  const auto oneOf = [&]<typename T, std::size_t n>(Draw draw, const std::array<T, n>& all) {
    return all.at(static_cast<std::size_t>(random.uniform(draw) * static_cast<double>(n)));
  };
  World world = toldWorld(board, camera);
  world.told_thickness_mm = between(kThickness, 0.1, 0.5);
  world.board.thickness_mm = world.told_thickness_mm * (1.0 + 0.025 * random.normal(kThicknessOff));
  world.board.transmission = between(kTransmission, 0.05, 0.3);
  world.board.print_transmission = 0.15 * world.board.transmission;
  world.board.light_law =
      oneOf(kLaw, std::array{twin::LightLaw::kBeer, twin::LightLaw::kScatter, twin::LightLaw::kLinear});
  if (const double begins = between(kWalls, 0.0, 0.6); begins > 0.05)
    world.board.depth_curve = {{begins, 0.0}, {1.0, 1.0}};
  if (random.uniform(kScorched) < 0.5) {
    world.board.scorch = {.fluence_j_mm2 = 0.5 * board.cut_fluence_j_mm2,
                          .darkening = between(kScorch, 0.05, 0.3),
                          .shift_mm = {between(kScorchX, -0.05, 0.05), between(kScorchY, -0.05, 0.05)}};
  }
  if (random.uniform(kGrained) < 0.5) world.texture.grain_gray = between(kGrain, 0.5, 3.0);
  world.roughness.rms_mm = between(kRough, 0.0, 0.002);
  world.radius = between(kRadius, 0.8, 1.2);
  world.foot = {.share = between(kFoot, 0.0, 0.15), .sigma_px = between(kFootSize, 1.0, 3.0)};
  world.corner = oneOf(kCorner, kCornerAngles);
  world.print = gaugeArtefact(world.corner).print;
  std::uint64_t next = kMarks;
  for (RegistrationMark& mark : world.print.marks) {
    mark.p_SM_mm.x() += kToldPrint_mm * random.normal(next++);
    mark.p_SM_mm.y() += kToldPrint_mm * random.normal(next++);
  }
  return world;
}

void lean(const vision::CameraCalibration& calibration, std::uint64_t seed, World& world) {
  if (!(calibration.telecentric_mm > 0.0)) return;
  const CounterRandom random(seed, kLeanStream);
  world.lean_rad = 0.5 * calibration.square_within_rad * Eigen::Vector2d(random.normal(0), random.normal(1));
}

std::string textOf(const World& world) {
  constexpr std::array kNames{"beer", "scatter", "linear"};
  const twin::BoardDescription& board = world.board;
  return fmt::format(
      "board {:.3f} mm (told {:.3f}), light {:.1f} % by {}, walls from {:.2f}, scorch {:.2f}, grain {:.1f}, "
      "rough {:.1f} um; beam {:.3f} of its radius; foot {:.1f} % of {:.2f} px; open {:.1f}; corner {}",
      board.thickness_mm, world.told_thickness_mm, 100.0 * board.transmission,
      kNames.at(static_cast<std::size_t>(board.light_law)),
      board.depth_curve.empty() ? 0.0 : board.depth_curve.front().fluence_share,
      board.scorch.fluence_j_mm2 > 0.0 ? board.scorch.darkening : 0.0, world.texture.grain_gray,
      1e3 * world.roughness.rms_mm, world.radius, 100.0 * world.foot.share, world.foot.sigma_px,
      world.open_gray, 30 * (1 + static_cast<int>(world.corner)));
}

}  // namespace kerfbench::gauge
