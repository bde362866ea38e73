// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/instrument.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "hil/vision/scan/kerf_scan.h"
#include "twin/base/random.h"
#include "twin/camera/camera.h"

namespace kerfbench::gauge {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kTilePlaceStream = 0x706c616365ULL;
constexpr double kBorder_mm = 2.5;        // Around the marks: the lay, and what a caliper reaches.
constexpr double kStationPitch_mm = 0.1;  // As in a run.
constexpr double kLayShift_mm = 1.0;
constexpr double kLayAngle_rad = 0.005;

class OneTile final : public camera::TileSource {
 public:
  explicit OneTile(camera::KerfTile tile) { tiles_.push_back(std::move(tile)); }
  std::vector<camera::KerfTile> nextBatch(std::size_t) override { return std::exchange(tiles_, {}); }

 private:
  std::vector<camera::KerfTile> tiles_;
};

/// The camera turned about the place that it looks at. What of a turn shows in the plane, the cosine of it,
/// is calibrated away.
void turn(const Eigen::Vector2d& lean_rad, twin::CameraDescription& camera) {
  const Eigen::Translation3d to(0.0, 0.0, camera.X_CP.translation().z());
  const Eigen::AngleAxisd about_x(lean_rad.x(), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd about_y(lean_rad.y(), Eigen::Vector3d::UnitY());
  camera.X_CP = to * about_x * about_y * to.inverse() * camera.X_CP;
  camera.fx_px /= std::cos(lean_rad.y());
  camera.fy_px /= std::cos(lean_rad.x());
}

/// An artefact is cut without a machine: there is no spot, no gate and no pulse. What rests on the kerf is
/// judged alone.
inspect::Verdict kerfVerdict(inspect::InspectionResult& result) {
  std::erase_if(result.problems, [](const std::string& problem) {
    return problem == "The spot camera gave no frame." ||
           problem == "There is no calibration of the spot camera.";
  });
  constexpr std::array<std::string_view, 9> kOwn{
      "path", "coverage", "bridges", "depth", "perforation", "stray", "kerf_width", "laser_timing", "joints"};
  std::erase_if(result.checks,
                [&](const inspect::Check& c) { return std::ranges::find(kOwn, c.name) == kOwn.end(); });
  result.verdict = inspect::combine(result.checks, result.problems.empty());
  return result.verdict;
}

}  // namespace

twin::CameraDescription windowOf(const twin::CameraDescription& camera, const SensorWindow& window) {
  twin::CameraDescription part = camera;
  part.width_px = window.width_px;
  part.height_px = window.height_px;
  part.cx_px -= window.x0_px;
  part.cy_px -= window.y0_px;
  return part;
}

vision::CameraCalibration windowOf(const vision::CameraCalibration& calibration, const SensorWindow& window) {
  vision::CameraCalibration part = calibration;
  part.width_px = window.width_px;
  part.height_px = window.height_px;
  part.cx_px -= window.x0_px;
  part.cy_px -= window.y0_px;
  return part;
}

KerfInstrument::KerfInstrument(const GaugeSetup& setup, const Artefact& artefact)
    : setup_(setup), artefact_(artefact) {
  Eigen::AlignedBox2d box = artefact.dieline.bounds();
  for (const RegistrationMark& mark : artefact.print.marks) {
    const Vector2d half = Vector2d::Constant(0.5 * mark.diameter_mm);
    box.extend(Eigen::AlignedBox2d(mark.p_SM_mm - half, mark.p_SM_mm + half));
  }
  const double pitch_mm = setup.kerf_calibration.pitchMm();
  const Vector2d size_mm = 2.0 * box.max().cwiseMax(-box.min()) + Vector2d::Constant(2.0 * kBorder_mm);
  width_px_ = static_cast<int>(std::ceil(size_mm.x() / pitch_mm));
  height_px_ = static_cast<int>(std::ceil(size_mm.y() / pitch_mm));
  if (width_px_ > setup.kerf_calibration.width_px || height_px_ > setup.kerf_calibration.height_px)
    throw std::invalid_argument("gauge: the artefact does not fit into the kerf camera's field");
}

Placement KerfInstrument::draw(std::uint64_t seed) const {
  const CounterRandom random(seed, kTilePlaceStream);
  const auto either = [&](std::uint64_t index, double most) {
    return most * (2.0 * random.uniform(index) - 1.0);
  };
  Placement placement;
  const vision::CameraCalibration& whole = setup_.kerf_calibration;
  placement.window = {static_cast<int>(random.uniform(0) * (whole.width_px - width_px_ + 1)),
                      static_cast<int>(random.uniform(1) * (whole.height_px - height_px_ + 1)), width_px_,
                      height_px_};
  placement.X_TS = Eigen::Translation2d(either(2, kLayShift_mm), either(3, kLayShift_mm)) *
                   Eigen::Rotation2Dd(either(4, kLayAngle_rad));
  placement.p_TV_mm = -whole.planeFromPixel(
      Vector2d(placement.window.x0_px + 0.5 * width_px_, placement.window.y0_px + 0.5 * height_px_));
  return placement;
}

camera::KerfTile KerfInstrument::picture(const twin::Sheet& sheet, const World& world,
                                         const Placement& placement, std::uint64_t board_seed,
                                         std::uint64_t noise_seed) const {
  twin::CameraDescription camera = windowOf(setup_.machine.kerf_camera, placement.window);
  if (camera.telecentric_mm > 0.0) turn(world.lean_rad, camera);
  camera.board_seed = board_seed;
  camera.fx_px *= world.scale;
  camera.fy_px *= world.scale;
  camera.open_gray = world.open_gray;
  camera.foot = world.foot;
  camera.texture = world.texture;
  camera.roughness = world.roughness;
  return {
      twin::KerfCamera(camera, world.print, noise_seed).render(sheet, 0, placement.p_TV_mm, placement.X_TS),
      placement.p_TV_mm, 0};
}

KerfMeasurement KerfInstrument::measure(camera::KerfTile tile, const Placement& placement,
                                        double thickness_mm) const {
  vision::KerfScanOptions options;
  options.station_pitch_mm = kStationPitch_mm;
  options.beam_radius_mm = setup_.machine.beam.waist_radius_mm;  // As the data sheet has it.
  options.beam_radius_sigma = setup_.radius_sigma;
  options.print_sigma_mm = setup_.print_sigma_mm;
  options.scale_sigma = setup_.scale_sigma;
  options.open_gray = setup_.machine.kerf_camera.open_gray;  // As the light was set up.
  options.open_gray_sigma = setup_.open_gray_sigma;
  options.board_thickness_mm = thickness_mm;
  const vision::CameraCalibration calibration = windowOf(setup_.kerf_calibration, placement.window);
  options.stray_min_mm = setup_.limits.leastStray_mm(calibration.pitchMm());
  OneTile source(std::move(tile));
  KerfMeasurement m;
  inspect::Evidence evidence;
  evidence.dieline = &artefact_.dieline;
  evidence.print = artefact_.print;
  evidence.kerf = scanKerf(source, calibration, artefact_.print, artefact_.dieline, options);
  evidence.kerf_calibration = calibration;
  m.result = inspect::inspect(evidence, setup_.limits);
  m.verdict = kerfVerdict(m.result);
  m.scan = std::move(evidence.kerf);
  return m;
}

}  // namespace kerfbench::gauge
