// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/fold_twin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/camera/twin/twin_tiles.h"
#include "hil/dieline/geometry.h"
#include "twin/base/random.h"
#include "twin/five_axis/folded_blank.h"
#include "twin/five_axis/survey_picture.h"

namespace kerfbench::fold {
namespace {

constexpr std::uint64_t kCalibrationStream = 0x73757276ULL;
constexpr std::uint64_t kSurveyNoise =
    1000;  // Seeds of one camera's pictures lie so far from the next one's.
constexpr double kDust_mm = 0.5;

using Mode = Eigen::Matrix<double, vision::CameraCalibration::kParameters, 1>;

/// One error mode for each parameter that a certificate names; both focal lengths are one.
std::vector<Mode> modesOf(const SurveyCamera& survey) {
  std::vector<Mode> modes;
  const auto add = [&](std::initializer_list<Eigen::Index> parameters, double sigma) {
    Mode mode = Mode::Zero();
    for (const Eigen::Index i : parameters) mode[i] = sigma;
    modes.push_back(mode);
  };
  const SurveyCertificate& c = survey.certificate;
  add({0, 1}, c.focal_share * survey.camera.fx_px);
  for (const Eigen::Index i : {2, 3}) add({i}, c.principal_px);
  for (const Eigen::Index i : {9, 10, 11}) add({i}, c.turn_rad);
  for (const Eigen::Index i : {12, 13, 14}) add({i}, c.shift_mm);
  return modes;
}

vision::CameraCalibration calibrationOf(const SurveyCamera& survey, std::uint64_t seed) {
  vision::CameraCalibration calibration;
  calibration.camera_id = survey.id;
  calibration.width_px = survey.camera.width_px;
  calibration.height_px = survey.camera.height_px;
  calibration.fx_px = survey.camera.fx_px;
  calibration.fy_px = survey.camera.fy_px;
  calibration.cx_px = survey.camera.cx_px;
  calibration.cy_px = survey.camera.cy_px;
  calibration.X_CP = survey.camera.X_CP;
  calibration.error_modes = modesOf(survey);
  Mode error = Mode::Zero();
  const CounterRandom random(seed, kCalibrationStream);
  for (std::size_t k = 0; k < calibration.error_modes.size(); ++k)
    error += random.normal(k) * calibration.error_modes[k];
  calibration.fx_px += error[0];
  calibration.fy_px += error[1];
  calibration.cx_px += error[2];
  calibration.cy_px += error[3];
  const Eigen::Vector3d turn = error.segment<3>(9);
  calibration.X_CP.linear() =
      Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * calibration.X_CP.linear();
  calibration.X_CP.translation() += error.tail<3>();
  return calibration;
}

std::uint64_t seedOf(const FoldScenario& scenario, std::size_t camera) {
  return scenario.seed * kSurveyNoise * kSurveyNoise + camera * kSurveyNoise;
}

}  // namespace

TwinFoldCameras::TwinFoldCameras(const FoldScenario& scenario, const twin::FoldedCut& cut, int threads)
    : scenario_(scenario), cut_(cut), threads_(threads) {}

std::vector<GrayImage> TwinFoldCameras::surveyPictures() {
  std::vector<GrayImage> pictures;
  const std::vector<SurveyCamera>& cameras = scenario_.machine.survey;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    pictures.push_back(
        twin::surveyPicture(cameras[i].camera, scenario_.blank.standing, seedOf(scenario_, i)));
  }
  return pictures;
}

std::unique_ptr<camera::TileSource> TwinFoldCameras::kerfTiles(std::size_t face) {
  const FoldKerfCamera& kerf = scenario_.machine.kerf;
  twin::CameraDescription camera = kerf.camera;
  camera.board_seed = scenario_.seed + face + 1;
  const std::uint64_t seed = seedOf(scenario_, face) + kSurveyNoise / 2;
  camera::TwinTileOptions options;
  options.threads = threads_;
  options.seed = seed;
  options.table = kerf.table;
  // All of the board is looked at, as strays may be anywhere.
  std::vector<Eigen::AlignedBox2d> boxes{scenario_.blank.standing[face].outline_F_mm};
  return std::make_unique<camera::TwinTileSource>(
      twin::KerfCamera(camera, scenario_.blank.standing[face].print, seed), cut_.sheets[face], boxes,
      options);
}

twin::FoldedCut cutOnTwin(const FoldScenario& scenario) {
  const twin::FiveAxisDescription& head = scenario.machine.head;
  const twin::FoldedBlank blank(scenario.blank.standing, head.waist_radius_mm, head.rayleigh_mm);
  return twin::cutFolded(head, blank, scenario.board, scenario.moves);
}

FoldInstruments instrumentsOf(const FoldScenario& scenario, int threads) {
  const FoldKerfCamera& kerf = scenario.machine.kerf;
  const twin::FiveAxisDescription& head = scenario.machine.head;
  FoldInstruments instruments;
  instruments.kerf = kerf.calibration;
  vision::KerfScanOptions& scan = instruments.scan;
  scan.threads = threads;
  scan.station_pitch_mm = inspect::kEdgePitch_mm;
  // Reaches the far edge of the widest kerf that lies where none should, and some board.
  scan.reach_mm = std::max(scan.reach_mm, 2.0 * scenario.job.kerf_radius_mm + 0.3);
  scan.stray_min_mm =
      std::max(0.0, std::min(kDust_mm, scenario.limits.stray_mm) - 2.0 * kerf.calibration.pitchMm());
  scan.patches = 0;
  scan.beam_radius_mm = head.waist_radius_mm;  // As the laser's data sheet has it.
  scan.beam_radius_sigma = scenario.machine.beam_radius_sigma;
  scan.board_thickness_mm = scenario.board.thickness_mm;
  scan.print_sigma_mm = scenario.print_sigma_mm;
  scan.table_sigma_mm = kerf.table_sigma_mm;
  scan.table_scale_sigma = kerf.table_scale_sigma;
  scan.scale_sigma = kerf.scale_sigma;
  scan.open_gray = kerf.camera.open_gray;  // As the light was set up.
  scan.open_gray_sigma = kerf.open_gray_sigma;
  instruments.space.beam_radius_mm = head.waist_radius_mm;
  instruments.space.board_transmission = scenario.board.transmission;
  instruments.space.kerf_map_u_mm = kerf.calibration.map_u_mm;
  for (std::size_t i = 0; i < scenario.machine.survey.size(); ++i) {
    instruments.survey.push_back(calibrationOf(scenario.machine.survey[i], seedOf(scenario, i)));
  }
  return instruments;
}

}  // namespace kerfbench::fold
