// SPDX-License-Identifier: Apache-2.0
// A spot anywhere in a frame of 2448 x 2048 pixels: found and fitted, compared with common alternatives.
// Pictures are taken beforehand; more of them than fit into a cache.
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "hil/vision/spot/spot_fit.h"
#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/spot_twin.h"
#include "tests/hil/vision/synthetic.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kFrames = 16;

struct Prepared {
  twin::CameraDescription camera = test::spotCamera(2448, 2048);
  std::vector<Frame> frames;
  std::vector<Vector2d> truth_px;

  Prepared() {
    const twin::SpotCamera spot_camera(camera, test::noPrint(), test::kGlowGrayPerW, 1);
    const CameraCalibration calibration = test::calibrationOf(camera);
    const CounterRandom random(1, 1);
    for (std::size_t i = 0; i < kFrames; ++i) {
      const Vector2d place_mm(200.0 * (random.uniform(2 * i) - 0.5),
                              160.0 * (random.uniform(2 * i + 1) - 0.5));
      frames.push_back(spot_camera.render(test::exposureOf(i, place_mm, {0.1, 0.05}, 110.0)));
      truth_px.push_back(calibration.pixelFromPlane(place_mm));
    }
  }
};

const Prepared& prepared() {
  static const Prepared once;
  return once;
}

/// Takes frames in turn; counts the errors of the results, in pixels.
template <typename Find>
void run(benchmark::State& state, const Find& find) {
  const Prepared& p = prepared();
  std::size_t i = 0;
  double squares = 0.0;
  std::size_t found = 0;
  for (auto _ : state) {
    const auto pixel = find(p.frames[i].image);
    if (pixel) {
      squares += (*pixel - p.truth_px[i]).squaredNorm();
      ++found;
    }
    i = (i + 1) % kFrames;
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["found"] = static_cast<double>(found) / static_cast<double>(state.iterations());
  state.counters["rms_px"] = std::sqrt(0.5 * squares / static_cast<double>(std::max<std::size_t>(1, found)));
}

void spotFoundAndFitted(benchmark::State& state) {
  const ShotNoise shot;
  run(state, [&](const GrayImage& image) -> std::optional<Vector2d> {
    const BrightnessScan scan = scanBrightness(image, 4);
    const Background& background = scan.background;
    for (const BrightPeak& peak : scan.peaks) {
      const PixelNoise noise = shot.on(background.median(), background.noise());
      if (const auto fit = fitSpot(image, peak, background.at(peak.column, peak.row), noise))
        return fit->pixel;
    }
    return std::nullopt;
  });
}

void backgroundAlone(benchmark::State& state) {
  run(state, [](const GrayImage& image) -> std::optional<Vector2d> {
    const Background background(image);
    benchmark::DoNotOptimize(background.noise());
    return std::nullopt;
  });
}

void spotFound(benchmark::State& state) {
  run(state, [](const GrayImage& image) -> std::optional<Vector2d> {
    const auto peaks = scanBrightness(image, 4).peaks;
    if (peaks.empty()) return std::nullopt;
    return Vector2d(peaks[0].column + 0.5, peaks[0].row + 0.5);
  });
}

/// Reads each byte of the frame once, as fast as the memory allows.
void frameReadOnce(benchmark::State& state) {
  run(state, [](const GrayImage& image) -> std::optional<Vector2d> {
    std::uint8_t highest = 0;
    for (const std::uint8_t value : image.pixels) highest = std::max(highest, value);
    benchmark::DoNotOptimize(highest);
    return std::nullopt;
  });
}

void runDetector(benchmark::State& state, const cv::SimpleBlobDetector::Params& params) {
  const auto detector = cv::SimpleBlobDetector::create(params);
  run(state, [&](const GrayImage& image) -> std::optional<Vector2d> {
    const cv::Mat picture(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
    std::vector<cv::KeyPoint> points;
    detector->detect(picture, points);
    if (points.empty()) return std::nullopt;
    return Vector2d(points[0].pt.x, points[0].pt.y);
  });
}

/// Detector with its defaults, but for bright blobs as small as a spot; 17 thresholds.
void simpleBlobDetector(benchmark::State& state) {
  cv::SimpleBlobDetector::Params params;
  params.blobColor = 255;
  params.minArea = 1.0F;
  params.filterByCircularity = params.filterByConvexity = params.filterByInertia = false;
  runDetector(state, params);
}

/// Detector with the board's brightness, so that no threshold lies in it.
void simpleBlobDetectorTuned(benchmark::State& state) {
  cv::SimpleBlobDetector::Params params;
  params.blobColor = 255;
  params.minArea = 1.0F;
  params.filterByCircularity = params.filterByConvexity = params.filterByInertia = false;
  params.minThreshold = 130.0F;
  params.maxThreshold = 191.0F;
  params.thresholdStep = 20.0F;
  runDetector(state, params);
}

BENCHMARK(spotFoundAndFitted)->Unit(benchmark::kMicrosecond);
BENCHMARK(spotFound)->Unit(benchmark::kMicrosecond);
BENCHMARK(backgroundAlone)->Unit(benchmark::kMicrosecond);
BENCHMARK(frameReadOnce)->Unit(benchmark::kMicrosecond);
BENCHMARK(simpleBlobDetectorTuned)->Unit(benchmark::kMicrosecond);
BENCHMARK(simpleBlobDetector)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kerfbench::vision

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
