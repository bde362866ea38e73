// SPDX-License-Identifier: Apache-2.0
// A sheet of 400 x 300 mm at 40 um to the pixel, on one core: the whole measurement (and on all), the path
// check alone, and the common alternative: threshold each picture and take the distances from the dieline,
// pixel by pixel. Pictures are taken beforehand.
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>
#include <thread>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/camera/kerf_tile.h"
#include "hil/camera/twin/twin_tiles.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/scan/kerf_scan.h"
#include "hil/vision/scan/kerf_unit.h"
#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/synthetic.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

/// Twelve cartons of 94 x 94 mm with rounded corners, flaps, creases and round holes.
test::TwinCut sheetOfCartons() {
  test::TwinCut cut;
  cut.camera = test::kerfCamera(0.04);
  cut.camera.width_px = 2048;
  cut.camera.height_px = 1536;
  cut.camera.cx_px = 1025.0;
  cut.camera.cy_px = 766.0;
  cut.print.marks.clear();
  for (const double x : {-196.0, 0.0, 196.0}) {
    for (const double y : {-146.0, 146.0}) cut.print.marks.push_back({{x, y}, 3.0});
  }
  cut.print.pitch_mm = 500.0;
  cut.options.station_pitch_mm = 0.25;
  for (int i = 0; i < 12; ++i) {
    const Vector2d c(-144.0 + 96.0 * (i % 4), -96.0 + 96.0 * (i / 4));  // NOLINT(bugprone-integer-division)
    const double h = 44.0;
    const double r = 4.0;
    for (int k = 0; k < 4; ++k) {
      const Eigen::Rotation2Dd turn(k * 0.5 * std::numbers::pi);
      const auto at = [&](double x, double y) -> Vector2d { return c + turn * Vector2d(x, y); };
      cut.add(dieline::LineCurve{at(-h + r, -h), at(h - r, -h)});
      cut.add(
          dieline::ArcCurve{at(h - r, -h + r), r, (k - 1) * 0.5 * std::numbers::pi, 0.5 * std::numbers::pi});
      cut.share_of[cut.add(dieline::LineCurve{at(-h + 8.0, -h + 12.0), at(h - 8.0, -h + 12.0)},
                           dieline::Process::kCrease)] = 0.6;
      cut.add(dieline::LineCurve{at(-h, -h + 20.0), at(-h + 10.0, -h + 20.0)});
      cut.add(dieline::ArcCurve{at(15.0, 15.0), 2.5, 0.0, 2.0 * std::numbers::pi});
    }
  }
  return cut;
}

struct Prepared {
  test::TwinCut cut = sheetOfCartons();
  CameraCalibration calibration = test::calibrationOf(cut.camera);
  std::vector<camera::KerfTile> tiles;
  double length_mm{};

  Prepared() {
    twin::Sheet sheet(cut.board);
    std::vector<Eigen::AlignedBox2d> boxes{
        Eigen::AlignedBox2d(Vector2d(-200.0, -150.0), Vector2d(200.0, 150.0))};
    for (const dieline::Entity& entity : cut.dieline.entities) {
      const auto share = cut.share_of.find(entity.id);
      cut.burn(sheet, entity.curve, 0.0, share == cut.share_of.end() ? 1.5 : share->second);
      length_mm += dieline::lengthOf(entity.curve);
    }
    camera::TwinTileOptions options;
    options.border_mm = 0.0;
    camera::TwinTileSource source(twin::KerfCamera(cut.camera, cut.print, 1), sheet, boxes, options);
    for (auto batch = source.nextBatch(8); !batch.empty(); batch = source.nextBatch(8)) {
      std::move(batch.begin(), batch.end(), std::back_inserter(tiles));
    }
    std::printf("%zu tiles of %d x %d px, %.1f m of dieline in %zu entities\n", tiles.size(),
                cut.camera.width_px, cut.camera.height_px, 1e-3 * length_mm, cut.dieline.entities.size());
  }
};

const Prepared& prepared() {
  static const Prepared once;
  return once;
}

void measureSheetOn(benchmark::State& state, int threads) {
  const Prepared& p = prepared();
  KerfScanOptions options = p.cut.options;
  options.threads = threads;
  std::size_t found = 0, calipers = 0;
  for (auto _ : state) {
    state.PauseTiming();
    test::ReadyTiles source(p.tiles);
    state.ResumeTiming();
    const KerfScan scan = scanKerf(source, p.calibration, p.cut.print, p.cut.dieline, options);
    found = calipers = 0;
    for (const EntityKerf& kerf : scan.entities) {
      for (const Caliper& c : kerf.calipers) found += c.found ? 1U : 0U;
      calipers += kerf.calipers.size();
    }
    if (!scan.problems.empty()) state.SkipWithError(scan.problems.front().c_str());
  }
  state.counters["calipers"] = static_cast<double>(calipers);
  state.counters["found"] = static_cast<double>(found);
}

void measureSheet(benchmark::State& state) { measureSheetOn(state, 1); }
void measureSheetOnAll(benchmark::State& state) {
  measureSheetOn(state, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Tiles that were examined and the placed unit, as for any check of the path.
struct Placed {
  std::vector<TileView> views;
  std::unique_ptr<TileIndex> index;
  PlaneMotion X_TS;
};

const Placed& placed() {
  static const Placed once = [] {
    const Prepared& p = prepared();
    Placed out;
    for (const camera::KerfTile& tile : p.tiles) out.views.push_back(viewTile(tile, p.calibration, {3.0}));
    shareLight(out.views);
    out.index = std::make_unique<TileIndex>(out.views, p.calibration);
    std::vector<std::string> problems;
    out.X_TS = placeUnit(out.views, *out.index, {0, &p.cut.print, 0.0}, p.calibration, problems).value().X_TS;
    return out;
  }();
  return once;
}

void pathAtPitch(benchmark::State& state, double pitch_mm) {
  const Prepared& p = prepared();
  const Placed& at = placed();
  KerfScanOptions options = p.cut.options;
  options.station_pitch_mm = pitch_mm;
  // The dieline is drawn beforehand as for the distances below: it is the same for every sheet.
  const KerfPlan plan = planKerf(p.cut.dieline, options);
  const SightDepths on_top{};
  double worst = 0.0;
  std::size_t calipers = 0;
  for (auto _ : state) {
    const TileIndex index(at.views, p.calibration);
    KerfScan scan;
    UnitScan(p.calibration, plan, options, {at.views, index, 0, at.X_TS, kUsualBlur, on_top}).cuts(scan);
    worst = 0.0;
    calipers = 0;
    for (const EntityKerf& kerf : scan.entities) {
      calipers += kerf.calipers.size();
      for (const Caliper& c : kerf.calipers) {
        if (c.found && !c.near_joint) worst = std::max(worst, std::abs(c.offset_mm));
      }
    }
  }
  state.counters["worst_um"] = 1e3 * worst;
  state.counters["calipers"] = static_cast<double>(calipers);
}

void pathByCalipers(benchmark::State& state) { pathAtPitch(state, 0.25); }
/// Path check with the pitch of `kerfbench run`.
void pathByCalipersDense(benchmark::State& state) { pathAtPitch(state, 0.1); }

/// Path check by the distance of every kerf pixel from the drawn dieline; half a kerf more than the path's
/// deviation, in whole pixels, blind to missing cuts.
void pathByDistanceTransform(benchmark::State& state) {
  const Prepared& p = prepared();
  const Placed& at = placed();
  std::vector<cv::Mat> drawn;
  for (const TileView& view : at.views) {
    cv::Mat lines(p.cut.camera.height_px, p.cut.camera.width_px, CV_8U, cv::Scalar(255));
    for (const dieline::Entity& entity : p.cut.dieline.entities) {
      std::vector<cv::Point> points;
      for (const double u : dieline::stations(entity.curve, 0.5)) {
        const auto pixel = p.calibration.pixelIfSeen(
            at.X_TS * dieline::pointAt(entity.curve, u) - view.tile.p_TV_mm, -200.0);
        if (pixel)
          points.emplace_back(static_cast<int>(std::lround(pixel->x())),
                              static_cast<int>(std::lround(pixel->y())));
      }
      cv::polylines(lines, std::vector<std::vector<cv::Point>>{points}, false, cv::Scalar(0));
    }
    drawn.push_back(lines);
  }
  double worst = 0.0;
  for (auto _ : state) {
    worst = 0.0;
    for (std::size_t t = 0; t < at.views.size(); ++t) {
      const GrayImage& image = at.views[t].tile.image;
      const cv::Mat picture(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
      cv::Mat kerf;
      cv::threshold(picture, kerf, 131.0, 255, cv::THRESH_BINARY);
      cv::Mat distance;
      cv::distanceTransform(drawn[t], distance, cv::DIST_L2, 5);
      double largest = 0.0;
      cv::minMaxLoc(distance, nullptr, &largest, nullptr, nullptr, kerf);
      worst = std::max(worst, largest * p.calibration.pitchMm());
    }
  }
  state.counters["worst_um"] = 1e3 * worst;
}

BENCHMARK(measureSheet)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK(measureSheetOnAll)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(3);
BENCHMARK(pathByCalipers)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(pathByCalipersDense)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(pathByDistanceTransform)->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
}  // namespace kerfbench::vision

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
