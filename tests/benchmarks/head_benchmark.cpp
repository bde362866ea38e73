// SPDX-License-Identifier: Apache-2.0
// kerfbench-head-benchmarks: the fit of a scan head with covariance, compared with OpenCV's of a camera with
// standard deviations, on the same number of points. Nothing is asserted.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "hil/base/freed_memory.h"
#include "hil/calibrate/head/head_fit.h"
#include "tests/hil/calibrate/head/campaign.h"
#include "twin/base/random.h"

namespace kerfbench::benchmarks {
namespace {

using namespace calibrate::test;

// Number of views of a camera's calibration, from docs/how-to/calibrate-a-camera.md.
constexpr int kViews = 9;

/// Errors of the pose of a sheet whose place is known to 0.4 µm and its turn to 2 µrad.
Eigen::Matrix<double, 2, 3> poseModesAt(const Eigen::Vector2d& p_mm) {
  Eigen::Matrix<double, 2, 3> modes;
  modes << 4e-4, 0.0, -2e-6 * p_mm.y(), 0.0, 4e-4, 2e-6 * p_mm.x();
  return modes;
}

/// Fits `side` x `side` marks on one sheet, made with the correction of a sheet of 3 x 3 as the procedure
/// does.
void fitHead(benchmark::State& state, calibrate::test::HeadKind kind, calibrate::test::Beyond beyond) {
  const calibrate::test::SimulatedHead head(kind, beyond, 1);
  calibrate::HeadFitOptions options;
  options.field_W_mm = head.field_W_mm();
  const calibrate::test::MarkedSheet nine = calibrate::test::mark(head, 3, 0, nullptr, {}, 1);
  const calibrate::HeadFit first = calibrate::fitHead(
      calibrate::pairMarks(nine.aimed, nine.seen).observations, head.nominal(), head.design(), options);
  const calibrate::test::MarkedSheet sheet =
      calibrate::test::mark(head, static_cast<int>(state.range(0)), 9, &first, {}, 1);
  auto marks = calibrate::pairMarks(sheet.aimed, sheet.seen).observations;
  for (calibrate::HeadObservation& o : marks) o.shared = calibrate::SharedError{0, poseModesAt(o.aim_W_mm)};
  for (auto _ : state) {
    const calibrate::HeadFit fit = calibrate::fitHead(marks, head.nominal(), head.design(), options);
    benchmark::DoNotOptimize(fit.covarianceAt_mm2({10.0, 20.0}));
  }
  state.counters["points"] = static_cast<double>(marks.size());
}

struct Views {
  std::vector<std::vector<cv::Point3f>> target;
  std::vector<std::vector<cv::Point2f>> pictures;
};

/// Views of a flat target of n x n corners in nine poses, tilted by 20 ... 30 degrees, with the corner noise
/// of a real picture.
Views viewsOf(int n) {
  const CounterRandom random(1, 99);
  const cv::Mat camera = (cv::Mat_<double>(3, 3) << 3000, 0, 900, 0, 3000, 900, 0, 0, 1);
  const cv::Mat lens = (cv::Mat_<double>(5, 1) << -0.1, 0.02, 5e-4, 3e-4, 0.0);
  std::vector<cv::Point3f> target;
  for (int i = 0; i < n * n; ++i)
    target.emplace_back(static_cast<float>(120.0 * (i % n) / (n - 1)),
                        static_cast<float>(120.0 * (i / n) / (n - 1)), 0.0F);
  Views views;
  std::uint64_t index = 0;
  for (int v = 0; v < kViews; ++v) {
    const double way = 0.7 * v;
    const cv::Mat turn = (cv::Mat_<double>(3, 1) << 0.45 * std::cos(way), 0.45 * std::sin(way), 0.1 * v);
    const cv::Mat shift = (cv::Mat_<double>(3, 1) << -60.0 + 2 * v, -60.0 - v, 450.0 + 10.0 * v);
    std::vector<cv::Point2f> picture;
    cv::projectPoints(target, turn, shift, camera, lens, picture);
    for (cv::Point2f& p : picture) {
      p.x += static_cast<float>(0.004 * random.normal(index++));
      p.y += static_cast<float>(0.004 * random.normal(index++));
    }
    views.target.push_back(target);
    views.pictures.push_back(picture);
  }
  return views;
}

/// Calibrates a camera with as many points as `side` x `side` marks, in nine views.
void calibrateCamera(benchmark::State& state) {
  cv::setNumThreads(1);
  const Views views = viewsOf(static_cast<int>(state.range(0)) / 3);
  for (auto _ : state) {
    cv::Mat camera, lens, turns, shifts, intrinsic_sigmas, extrinsic_sigmas, errors;
    benchmark::DoNotOptimize(cv::calibrateCamera(views.target, views.pictures, {1800, 1800}, camera, lens,
                                                 turns, shifts, intrinsic_sigmas, extrinsic_sigmas, errors));
  }
  state.counters["points"] = static_cast<double>(kViews * views.target.front().size());
}

BENCHMARK_CAPTURE(fitHead, two_mirror_300, calibrate::test::HeadKind::kTwoMirror300,
                  calibrate::test::Beyond::kNothing)
    ->Arg(6)
    ->Arg(9)
    ->Arg(18)
    ->Arg(24)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fitHead, two_mirror_300_with_surface, calibrate::test::HeadKind::kTwoMirror300,
                  calibrate::test::Beyond::kAnalogue)
    ->Arg(18)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fitHead, f_theta_300, calibrate::test::HeadKind::kFTheta300,
                  calibrate::test::Beyond::kNothing)
    ->Arg(6)
    ->Arg(9)
    ->Arg(18)
    ->Arg(24)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(calibrateCamera)->Arg(6)->Arg(9)->Arg(18)->Arg(24)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kerfbench::benchmarks

int main(int argc, char** argv) {
  kerfbench::base::keepFreedMemory();  // `kerfbench` does the same; both sides gain.
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
