// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/kerf_watch.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "hil/scenario/camera_files.h"
#include "hil/vision/scan/kerf_scan.h"

namespace kerfbench::judge {
namespace {

// Close enough to see the missing start of a line where the laser comes 2 ms late (0.2 mm at 20 m/s²).
constexpr double kMeasuredBegin = 0.03;
constexpr double kMeasuredLaw = 0.4;
constexpr double kStationPitch_mm = 0.1;
/// A page with such a picture stays below a megabyte.
constexpr int kMosaic_px = 640;
// Units of a few MB of web each.
constexpr std::size_t kMostWaiting = 2;

}  // namespace

vision::KerfScanOptions kerfScanOptions(const scenario::Case& test_case,
                                        const vision::CameraCalibration& calibration, int threads) {
  vision::KerfScanOptions options;
  options.threads = threads;
  options.station_pitch_mm = kStationPitch_mm;
  options.mosaic_px = kMosaic_px;
  options.stray_min_mm = test_case.scenario.limits.leastStray_mm(calibration.pitchMm());
  options.beam_radius_mm = test_case.machine.beam.waist_radius_mm;     // As the laser's data sheet has it.
  options.board_thickness_mm = test_case.scenario.board.thickness_mm;  // As the board's has it.
  options.beam_radius_sigma = test_case.beam_radius_sigma;
  options.print_sigma_mm = test_case.scenario.print_sigma_mm;
  if (const auto& curve = test_case.scenario.board.depth_curve; !curve.empty()) {
    // Somebody has measured the material: what is left is that of the measurement.
    options.growth.begin = curve.front().fluence_share;
    options.begin_sigma = kMeasuredBegin;
    options.law_sigma = kMeasuredLaw;
  }
  const machine_file::CameraFile& camera = test_case.kerf_camera;
  // A bow moves tiles as a bad stop does, and neighbours alike.
  options.table_sigma_mm = std::hypot(camera.table_sigma_mm, camera.table_straightness_mm);
  options.table_scale_sigma = camera.table_scale_sigma;
  options.scale_sigma = std::hypot(camera.target_scale_sigma, test_case.scenario.swelling_sigma);
  options.open_gray = test_case.machine.kerf_camera.open_gray;  // As the light was set up.
  options.open_gray_sigma = camera.open_gray_sigma;
  return options;
}

std::unique_ptr<KerfWatch> KerfWatch::of(const scenario::Case& test_case, camera::MachineCameras& cameras,
                                         int threads) {
  const scenario::Scenario& scenario = test_case.scenario;
  const bool is_stopped = scenario.provoke.cause != scenario::ProvokeChoice::Cause::kNone;
  if (!scenario.cameras.kerf.tiles.empty() || scenario.cameras.spot.is_real || is_stopped) return nullptr;
  scenario::BenchCameras calibrated = scenario::readCalibrations(test_case);
  if (!calibrated.spot || !calibrated.kerf) return nullptr;
  std::unique_ptr<camera::TilesMeanwhile> tiles = cameras.kerfTilesMeanwhile(
      threads, threads > 1 ? kMostWaiting : std::numeric_limits<std::size_t>::max());
  if (!tiles) return nullptr;
  return std::unique_ptr<KerfWatch>(
      new KerfWatch(test_case, std::move(tiles), std::move(*calibrated.kerf), threads));
}

KerfWatch::KerfWatch(const scenario::Case& test_case, std::unique_ptr<camera::TilesMeanwhile> tiles,
                     vision::CameraCalibration calibration, int threads)
    : test_case_(test_case),
      tiles_(std::move(tiles)),
      calibration_(std::move(calibration)),
      threads_(threads) {
  if (threads > 1) thread_ = std::thread([this] { measure(); });
}

KerfWatch::~KerfWatch() {
  tiles_->close();
  if (thread_.joinable()) thread_.join();
}

void KerfWatch::measure() {
  try {
    scan_ = vision::scanKerf(*tiles_, calibration_, test_case_.scenario.print, *test_case_.dieline,
                             kerfScanOptions(test_case_, calibration_, threads_));
  } catch (...) {
    failure_ = std::current_exception();
    tiles_->close();
  }
}

vision::KerfScan KerfWatch::finished() {
  if (thread_.joinable()) {
    thread_.join();
  } else {
    measure();
  }
  if (failure_) std::rethrow_exception(failure_);
  return std::move(scan_);
}

}  // namespace kerfbench::judge
