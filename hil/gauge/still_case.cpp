// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/still_case.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "hil/camera/twin/twin_frames.h"
#include "hil/dieline/geometry.h"
#include "hil/gauge/beam.h"
#include "hil/vision/spot/spot_track.h"
#include "twin/base/constants.h"
#include "twin/base/random.h"

namespace kerfbench::gauge {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kSheetPlaceStream = 0x7374696c6cULL;
constexpr double kCutSpeed_mm_s = 300.0;
constexpr double kCut_s = 0.04;
constexpr double kPause_s = 0.008;
constexpr double kLead_s = 0.005;
constexpr double kSkew_rad = 2e-3;  // Standard deviation.
constexpr double kCutEnergy_j_mm = 0.105;
constexpr int kParts = 8;  // Parts of an exposure.
constexpr double kWindowX_mm = 62.0;
constexpr double kWindowY_mm = 44.0;

double beginOf(std::size_t cut) { return kLead_s + static_cast<double>(cut) * (kCut_s + kPause_s); }

SensorWindow drawWindow(const vision::CameraCalibration& whole, const CounterRandom& random) {
  SensorWindow window;
  window.width_px = std::min(whole.width_px, static_cast<int>(kWindowX_mm / whole.pitchMm()));
  window.height_px = std::min(whole.height_px, static_cast<int>(kWindowY_mm / whole.pitchMm()));
  // Not at the rim, which the calibration's area does not reach.
  const auto place = [&](std::uint64_t index, int all, int part) {
    const int rim = std::min((all - part) / 2, all / 40);
    return rim + static_cast<int>(random.uniform(index) * (all - part - 2 * rim + 1));
  };
  window.x0_px = place(0, whole.width_px, window.width_px);
  window.y0_px = place(1, whole.height_px, window.height_px);
  return window;
}

struct Line {
  double slope{}, mean{}, middle_s{};
};
Line lineThrough(const std::vector<double>& t, const std::vector<double>& x) {
  const auto n = static_cast<double>(t.size());
  Line line;
  for (std::size_t i = 0; i < t.size(); ++i) {
    line.middle_s += t[i] / n;
    line.mean += x[i] / n;
  }
  double tt = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    tt += (t[i] - line.middle_s) * (t[i] - line.middle_s);
    line.slope += (t[i] - line.middle_s) * x[i];
  }
  line.slope /= tt;
  return line;
}

/// How far the beam lay off its line, and strayed from its mean place.
struct Strayed {
  double peak_mm{}, excursion_mm{}, rms_mm{};
};
Strayed strayedBy(const std::vector<double>& x_mm, double mean_mm) {
  Strayed strayed;
  double squares = 0.0;
  for (const double x : x_mm) {
    strayed.peak_mm = std::max(strayed.peak_mm, std::abs(x));
    strayed.excursion_mm = std::max(strayed.excursion_mm, std::abs(x - mean_mm));
    squares += (x - mean_mm) * (x - mean_mm);
  }
  strayed.rms_mm = std::sqrt(squares / static_cast<double>(x_mm.size()));
  return strayed;
}

}  // namespace

/// The web and the beam in time.
class StillStudy::Web {
 public:
  Web(const GaugeSetup& setup, const StillCase& c, const dieline::Dieline& dieline,
      const SensorWindow& window)
      : case_(c), dieline_(dieline) {
    const twin::SampledMachine sampled =
        twin::drawImperfections(setup.machine, setup.spread, c.preset, c.machine_seed);
    const CounterRandom random(c.place_seed, kSheetPlaceStream);
    const Vector2d centre_W_mm = setup.spot_calibration.planeFromPixel(
        Vector2d(window.x0_px + 0.5 * window.width_px, window.y0_px + 0.5 * window.height_px));
    beam_ = std::make_unique<ArtefactBeam>(sampled.machine, centre_W_mm);
    radius_mm_ = std::sqrt(beam_->radius_x_mm * beam_->radius_y_mm);
    power_w_ = kCutEnergy_j_mm * kCutSpeed_mm_s * sampled.machine.laser.full_power_w /
               setup.machine.laser.full_power_w;
    skew_rad_ = kSkew_rad * random.normal(2);
    start_mm_ = centre_W_mm + Vector2d(-0.5 * c.speed_mm_s * beginOf(3) + 2.0 * random.uniform(10) - 1.0,
                                       2.0 * random.uniform(11) - 1.0);
    const twin::EncoderDescription& told = setup.machine.belt.encoder;
    const twin::EncoderDescription& is = sampled.machine.belt.encoder;
    outrun_ = is.count_mm / told.count_mm - 1.0;
    runout_mm_ = is.runout_mm;
    runout_phase_rad_ = is.runout_phase_rad;
    roller_mm_ = sampled.machine.belt.roller_radius_mm;
    waves_ = 1.0 + 2.0 * random.uniform(12);
  }

  [[nodiscard]] Vector2d p_WS_mm(double t_s) const {
    return start_mm_ + Vector2d(case_.speed_mm_s * t_s, 0.0);
  }
  [[nodiscard]] double skew_rad() const { return skew_rad_; }
  [[nodiscard]] double radius_mm() const { return radius_mm_; }
  [[nodiscard]] double power_w() const { return power_w_; }
  /// Offset of the beam on the web, along Wx.
  [[nodiscard]] double residual_mm(std::size_t cut, double t_s) const {
    const StillCase::Cut& c = case_.cuts.at(cut);
    const double share = (t_s - beginOf(cut)) / kCut_s - 0.5;
    const double travel_mm = case_.speed_mm_s * (t_s - beginOf(cut));
    const double turn = case_.speed_mm_s * t_s / roller_mm_;
    return c.offset_mm + c.drift_mm * share + c.sway_mm * std::sin(kTurn_rad * waves_ * share) +
           outrun_ * travel_mm + runout_mm_ * std::sin(turn + runout_phase_rad_) +
           beam_->flutterShift_mm(t_s).x();
  }
  [[nodiscard]] Vector2d spot_mm(std::size_t cut, double t_s) const {
    const double u = (t_s - beginOf(cut)) / kCut_s;
    const Vector2d p_S_mm = dieline::pointAt(dieline_.entities[cut].curve, u);
    return p_WS_mm(t_s) + Eigen::Rotation2Dd(skew_rad_) * p_S_mm + Vector2d(residual_mm(cut, t_s), 0.0);
  }

 private:
  const StillCase& case_;
  const dieline::Dieline& dieline_;
  std::unique_ptr<ArtefactBeam> beam_;
  double radius_mm_{}, power_w_{}, skew_rad_{}, outrun_{}, runout_mm_{}, runout_phase_rad_{}, roller_mm_{1.0};
  double waves_{1.0};
  Vector2d start_mm_{Vector2d::Zero()};
};

StillStudy::StillStudy(const GaugeSetup& setup) : setup_(setup) {
  dieline_.path = "gauge cross-cuts";
  const auto add = [&](const Vector2d& from, const Vector2d& to) {
    dieline::Entity& entity = dieline_.entities.emplace_back();
    entity.id = static_cast<int>(dieline_.entities.size()) - 1;
    entity.curve = dieline::LineCurve{from, to};
  };
  add({5.0, -6.0}, {5.0, 6.0});
  add({1.5, 5.8}, {-1.5, -5.8});
  add({-5.0, -6.0}, {-5.0, 6.0});
  print_.units = 1;
  print_.pitch_mm = 80.0;
  print_.marks = {{{-13.0, -11.0}, 3.0}, {{13.0, -11.4}, 3.0}, {{-12.7, 11.0}, 3.0}, {{13.0, 11.0}, 3.0}};
}

std::vector<twin::Exposure> StillStudy::watch(const StillCase& test_case, const Web& web) const {
  const twin::CameraDescription& camera = setup_.machine.spot_camera;
  const auto frames = static_cast<std::uint64_t>(beginOf(test_case.cuts.size()) / camera.frame_period_s);
  std::vector<twin::Exposure> exposures;
  for (std::uint64_t k = 0; k < frames; ++k) {
    twin::Exposure& e = exposures.emplace_back();
    e.sequence = k;
    e.start_s = static_cast<double>(k) * camera.frame_period_s;
    for (int i = 0; i < kParts; ++i) {
      const double t_s = e.start_s + (i + 0.5) / kParts * camera.exposure_s;
      twin::ExposureSample& sample = e.samples.emplace_back();
      sample.p_WS_mm = web.p_WS_mm(t_s);
      sample.angle_rad = web.skew_rad();
      sample.radius_mm = web.radius_mm();
      for (std::size_t cut = 0; cut < test_case.cuts.size(); ++cut) {
        if (t_s < beginOf(cut) || t_s > beginOf(cut) + kCut_s) continue;
        sample.p_WQ_mm = web.spot_mm(cut, t_s);
        sample.power_w = web.power_w();
      }
    }
  }
  return exposures;
}

StillOutcome StillStudy::run(const StillCase& test_case) const {
  const CounterRandom random(test_case.place_seed, kSheetPlaceStream);
  const SensorWindow window = drawWindow(setup_.spot_calibration, random);
  const Web web(setup_, test_case, dieline_, window);
  twin::CameraDescription camera = windowOf(setup_.machine.spot_camera, window);
  camera.board_seed = test_case.board_seed;
  const vision::CameraCalibration calibration = windowOf(setup_.spot_calibration, window);
  camera::TwinFrameSource frames(
      twin::SpotCamera(camera, print_, setup_.machine.glow_gray_per_w, test_case.noise_seed),
      watch(test_case, web), 1);
  inspect::Evidence evidence;
  evidence.dieline = &dieline_;
  evidence.print = print_;
  evidence.spot = vision::trackSpot(frames, calibration, print_, {1, test_case.speed_mm_s});
  evidence.spot_calibration = calibration;
  // No kerf is measured here, but inspection needs every entity.
  for (const dieline::Entity& e : dieline_.entities) evidence.kerf.entities.push_back({0, e.id, {}});
  const inspect::InspectionResult result = inspect::inspect(evidence, setup_.limits);

  StillOutcome out;
  out.name = test_case.name;
  out.problems = evidence.spot.problems;
  inspect::Check farthest;
  for (const inspect::Check& check : result.checks) {
    if (check.name == "stillness_x") out.verdict = check.verdict;
    if (check.name == "stillness_peak") farthest = check;
  }
  double largest_excursion = 0.0;
  const std::size_t pick = CounterRandom(test_case.machine_seed, 2).bits(0) % test_case.cuts.size();
  for (const inspect::CutResult& cut : result.cuts) {
    if (cut.entity < 0 || cut.time_s.size() < 2 || !std::isfinite(cut.drift_mm)) continue;
    const auto which = static_cast<std::size_t>(cut.entity);
    std::vector<double> x;
    for (const double t : cut.time_s) x.push_back(web.residual_mm(which, t));
    const Line line = lineThrough(cut.time_s, x);
    const double duration_s = cut.time_s.back() - cut.time_s.front();
    const double drift_mm = line.slope * duration_s;
    out.truth_mm = std::max(out.truth_mm, std::abs(drift_mm));
    const Strayed strayed = strayedBy(x, line.mean);
    largest_excursion = std::max(largest_excursion, strayed.excursion_mm);
    if (which != pick) continue;
    out.readings.push_back({"drift of a cut", cut.drift_mm, 2.0 * cut.drift_sigma_mm, drift_mm});
    out.readings.push_back(
        {"excursion of a cut", cut.excursion_mm, cut.excursion_U_mm, strayed.excursion_mm});
    out.readings.push_back({"peak of a cut", cut.peak_mm, cut.peak_U_mm, strayed.peak_mm});
    out.readings.push_back({"RMS of a cut", cut.rms_mm, cut.rms_U_mm, strayed.rms_mm});
  }
  if (out.readings.empty()) {
    // The cut is there and shows x: that nothing was measured of it counts.
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    out.readings.push_back({"drift of a cut", kNan, kNan, test_case.cuts[pick].drift_mm});
  }
  out.readings.push_back({"largest excursion of all cuts", farthest.value, farthest.u, largest_excursion});
  for (const inspect::UncertaintyBudget& b : result.budgets) {
    if (b.quantity.find("drift") == std::string::npos) continue;
    out.readings.push_back({"largest drift of all cuts", b.monte_carlo_value, b.monte_carlo_U, out.truth_mm});
    out.analytic_U_mm = b.analytic_U;
    out.monte_carlo_U_mm = b.monte_carlo_U;
  }
  return out;
}

}  // namespace kerfbench::gauge
