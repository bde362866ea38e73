// SPDX-License-Identifier: Apache-2.0
// Cost of a picture of the model. Nothing is asserted about time.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "tests/twin/camera/cameras.h"
#include "twin/camera/target_camera.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

PrintLayout fourMarks() {
  PrintLayout print;
  print.pitch_mm = 500.0;
  for (const Vector2d& p : {Vector2d(-10, -10), Vector2d(10, -10), Vector2d(-10, 10), Vector2d(10, 10)})
    print.marks.push_back({p, 3.0});
  return print;
}

void spotFrame(benchmark::State& state, const CameraDescription& description) {
  const SpotCamera camera(description, fourMarks(), 4.0, 1);
  Exposure exposure{.samples = {{.p_WQ_mm = {3.1, 4.7}, .radius_mm = 0.105, .power_w = 25.0}}};
  for (auto _ : state) {
    ++exposure.sequence;
    benchmark::DoNotOptimize(camera.render(exposure));
  }
}

void kerfTile(benchmark::State& state, const CameraDescription& description) {
  const KerfCamera camera(description, fourMarks(), 1);
  Sheet sheet{BoardDescription{}};
  // The cut has half a metre in a field of 82 x 61 mm.
  for (int i = 0; i < 8; ++i) {
    const Vector2d from(-35.0, -21.0 + 6.0 * i);
    sheet.burn({from, 0.105, 0.105}, {from + Vector2d(65.0, 5.0), 0.105, 0.105}, 0.1 * 65.0);
  }
  for (auto _ : state)
    benchmark::DoNotOptimize(camera.render(sheet, 0, {0, 0}, Eigen::Isometry2d::Identity()));
}

void targetView(benchmark::State& state, const CameraDescription& description) {
  TargetBoard board;
  board.columns = 30;
  board.rows = 22;
  board.square_mm = 3.0;
  const TargetCamera camera(description, board, 1);
  const Eigen::Isometry3d X_CB = Eigen::Translation3d(0, 0, 500) *
                                 Eigen::AngleAxisd(0.3, Eigen::Vector3d(1.0, 0.5, 0.2).normalized()) *
                                 Eigen::Translation3d(-45.0, -33.0, 0.0);
  std::uint64_t view = 0;
  for (auto _ : state) benchmark::DoNotOptimize(camera.render(X_CB, ++view));
}

void add(const std::string& name, void (*work)(benchmark::State&, const CameraDescription&),
         const CameraDescription& description) {
  benchmark::RegisterBenchmark(name.c_str(), [work, description](benchmark::State& state) {
    work(state, description);
  })->Unit(benchmark::kMillisecond);
}

using Change = void (*)(CameraDescription&);

struct Hardship {
  const char* name;
  Change change;
};
const Hardship kOfSpot[] = {
    {"10 bits", [](CameraDescription& camera) { camera.bits = 10; }},
    {"grain", [](CameraDescription& camera) { camera.texture.grain_gray = 3.0; }},
    {"grain around print and spot",
     [](CameraDescription& camera) {
       camera.texture.grain_gray = 3.0;
       camera.texture.grain_everywhere = false;
     }},
    {"glow texture", [](CameraDescription& camera) { camera.texture.glow_share = 0.1; }},
    {"plume", [](CameraDescription& camera) { camera.plume.share = 0.1; }},
    {"uneven light",
     [](CameraDescription& camera) {
       camera.light = {0.2, 0.1, 0.1};
     }},
    {"hot pixels", [](CameraDescription& camera) { camera.hot.share = 1e-4; }},
};
const Hardship kOfKerf[] = {
    {"10 bits", [](CameraDescription& camera) { camera.bits = 10; }},
    {"grain",
     [](CameraDescription& camera) { camera.texture = {.grain_gray = 3.0, .grain_length_mm = 0.06}; }},
    {"roughness", [](CameraDescription& camera) { camera.roughness.rms_mm = 0.008; }},
    {"uneven light",
     [](CameraDescription& camera) {
       camera.light = {0.2, 0.1, 0.1};
     }},
};

void addAll() {
  const auto spotCamera = [](int width, int height) { return cameraAbove(width, height, 0.1); };
  for (const auto& [width, height] : {std::pair{640, 480}, {1280, 1024}, {2448, 2048}}) {
    const std::string name = "spot " + std::to_string(width) + "x" + std::to_string(height);
    add(name, spotFrame, spotCamera(width, height));
    for (const Hardship& hardship : kOfSpot) {
      CameraDescription camera = spotCamera(width, height);
      hardship.change(camera);
      add(name + ", " + hardship.name, spotFrame, camera);
    }
  }
  const CameraDescription kerf = cameraAbove(2048, 1536, 0.04);
  add("kerf 2048x1536", kerfTile, kerf);
  for (const Hardship& hardship : kOfKerf) {
    CameraDescription camera = kerf;
    hardship.change(camera);
    add(std::string("kerf 2048x1536, ") + hardship.name, kerfTile, camera);
  }
  add("target 2048x1536", targetView, kerf);
}

}  // namespace
}  // namespace kerfbench::twin

int main(int argc, char** argv) {
  kerfbench::twin::addAll();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
