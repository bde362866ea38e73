// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/inspect/synthetic_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_profile.h"

namespace kerfbench::inspect::testing {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kBelt_mm_s = 200.0;
constexpr double kCut_mm_s = 300.0;
constexpr double kPitch_mm = 80.0;
constexpr double kNoise_mm = 0.001;  // Noise of one caliper.

dieline::Curve line(double x0, double y0, double x1, double y1) {
  return dieline::LineCurve{{x0, y0}, {x1, y1}};
}

/// A camera that looks straight down on a square around the origin, known to about 0.1 um.
vision::CameraCalibration smallCamera(double half_mm) {
  vision::CameraCalibration c;
  c.width_px = c.height_px = 2000;
  c.fx_px = c.fy_px = 10000.0;
  c.cx_px = c.cy_px = 999.5;
  c.X_CP.linear() = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  c.X_CP.translation() = Eigen::Vector3d(0.0, 0.0, 10.0 * half_mm);
  c.camera_id = "small";
  c.date = "2024-05-01";
  c.rms_px = 0.005;
  c.map_u_mm = 1e-4;
  c.area_mm = Eigen::AlignedBox2d(Eigen::Vector2d(-half_mm, -half_mm), Eigen::Vector2d(half_mm, half_mm));
  for (const Eigen::Index parameter : {0, 2, 3}) {
    // The modes are focal length and principal point.
    c.error_modes.emplace_back(Eigen::Matrix<double, vision::CameraCalibration::kParameters, 1>::Zero());
    c.error_modes.back()[parameter] = 1e3 / half_mm * 1e-4;
  }
  return c;
}

}  // namespace

void unburn(vision::Caliper& caliper) {
  caliper.found = false;
  caliper.offset_mm = caliper.width_mm = std::numeric_limits<double>::quiet_NaN();
  caliper.brightness = 0.0;
}

SyntheticRun::SyntheticRun() {
  const std::vector<std::pair<dieline::Curve, dieline::Process>> parts = {
      {line(0, 0, 60, 0), dieline::Process::kCut},
      {line(60, 0, 60, 40), dieline::Process::kCut},
      {line(60, 40, 0, 40), dieline::Process::kCut},
      {line(0, 40, 0, 0), dieline::Process::kCut},
      {dieline::ArcCurve{{15, 20}, 6, 0, 2 * std::numbers::pi}, dieline::Process::kCut},
      {line(30, 2, 30, 38), dieline::Process::kCrease},
      {line(45, 2, 45, 37), dieline::Process::kPerforation},
      {line(0, -10, 20, -10), dieline::Process::kIgnore},
  };
  for (const auto& [curve, process] : parts) {
    const int id = static_cast<int>(dieline.entities.size());
    dieline.entities.push_back({id, curve, process, process == dieline::Process::kCut ? "CUT" : "OTHER",
                                "line " + std::to_string(10 * id + 4) + ": LINE"});
  }
  evidence.dieline = &dieline;
  evidence.print.units = 2;
  evidence.print.pitch_mm = kPitch_mm;
  for (const double x : {-5.0, 65.0}) {
    for (const double y : {-5.0, 45.0}) evidence.print.marks.push_back({{x, y}, 3.0});
  }
  evidence.kerf_calibration = smallCamera(60.0);
  evidence.spot_calibration = smallCamera(3000.0);
  for (int unit = 0; unit < evidence.print.units; ++unit) {
    Eigen::Matrix3d covariance = Eigen::Vector3d(1e-8, 1e-8, 1e-12).asDiagonal();
    evidence.kerf.units.push_back({unit, {-30.0, -20.0}, 0.0, covariance, 0.001, 4});
  }
  evidence.kerf.mark_residual_mm = 0.001;
  PulseTiming timing;
  timing.profile = {.name = "two-phase driver",
                    .active_edge_rising = true,
                    .setup_s = 5e-6,
                    .hold_s = 5e-6,
                    .width_s = 2.5e-6,
                    .space_s = 2.5e-6};
  timing.pulses = 120000;
  timing.min_setup_s = 12e-6;
  timing.min_hold_s = 9e-6;
  timing.min_width_s = 4e-6;
  timing.min_space_s = 6e-6;
  timing.setup_histogram.assign(64, 0);
  for (std::size_t i = 24; i < 64; ++i) timing.setup_histogram[i] = 40 + 37 * i;
  timing.setup_histogram.back() = 110000;
  for (const char* axis : {"galvo_x", "galvo_y"}) {
    timing.axis = axis;
    evidence.pulses.push_back(timing);
  }
  addKerf();
  addFrames();
  for (const GateInterval& gate : evidence.gates) evidence.light.push_back({gate.on_s, gate.off_s});
  evidence.guard_open.emplace();
  evidence.belt_count_mm = 0.01;
  const double end_mm = kBelt_mm_s * evidence.spot.frames.back().mid_s;
  for (int count = 1; 0.01 * count <= end_mm; ++count)
    evidence.belt.push_back({0.01 * count / kBelt_mm_s, 0.01 * count});
}

SyntheticRun::SyntheticRun(const SyntheticRun& other)
    : dieline(other.dieline),
      evidence(other.evidence),
      limits(other.limits),
      stretches_(other.stretches_),
      noise_state_(other.noise_state_) {
  evidence.dieline = &dieline;
}

double SyntheticRun::noise() {
  // A sum of uniforms is near enough to a normal value, and the same everywhere.
  double sum = 0.0;
  for (int i = 0; i < 12; ++i) {
    noise_state_ = noise_state_ * 1664525U + 1013904223U;
    sum += static_cast<double>(noise_state_ >> 8U) / 16777216.0;
  }
  return sum - 6.0;
}

void SyntheticRun::addKerf() {
  for (int unit = 0; unit < evidence.print.units; ++unit) {
    for (const dieline::Entity& entity : dieline.entities) {
      if (entity.process == dieline::Process::kIgnore) continue;
      vision::EntityKerf kerf{unit, entity.id, {}};
      const double length_mm = dieline::lengthOf(entity.curve);
      for (const double u : dieline::stations(entity.curve, 0.25)) {
        vision::Caliper c;
        c.u = u;
        c.station_mm = u * length_mm;
        c.p_S_mm = dieline::pointAt(entity.curve, u);
        c.p_V_mm = c.p_S_mm - Eigen::Vector2d(30.0, 20.0);
        const bool outline = entity.id <= kLeft;
        c.near_joint = outline && (c.station_mm < 0.4 || c.station_mm > length_mm - 0.4);
        c.found = true;
        c.brightness = entity.process == dieline::Process::kCrease ? 0.4 : 1.0;
        c.offset_mm = c.found ? kNoise_mm * noise() : std::numeric_limits<double>::quiet_NaN();
        c.width_mm = c.found
                         ? (entity.process == dieline::Process::kCrease ? 0.15 : 0.21) + kNoise_mm * noise()
                         : std::numeric_limits<double>::quiet_NaN();
        c.sigma_mm = c.width_sigma_mm = c.found ? kNoise_mm : std::numeric_limits<double>::quiet_NaN();
        kerf.calipers.push_back(c);
      }
      evidence.kerf.entities.push_back(std::move(kerf));
    }
    perforate(unit, cutsOf(3.0, 1.0));
  }
}

void SyntheticRun::addFrame(bool lit, int unit, const Eigen::Vector2d& p_S_mm) {
  auto& frames = evidence.spot.frames;
  vision::FrameMeasurement frame;
  frame.sequence = frames.size();
  frame.mid_s = kPeriod_s * static_cast<double>(frames.size());
  for (int k = 0; k < evidence.print.units; ++k) {
    // Every third frame has no mark of the unit in view: the pose must be interpolated.
    if (frames.size() % 3 == 2) continue;
    frame.sheet.push_back({k, {kBelt_mm_s * frame.mid_s - kPitch_mm * k, 0.0}, 0.0, 0.001, 4});
  }
  if (lit) {
    const Eigen::Vector2d origin_W_mm(kBelt_mm_s * frame.mid_s - kPitch_mm * unit, 0.0);
    frame.spot_W_mm = p_S_mm + origin_W_mm + Eigen::Vector2d(0.002 * noise(), 0.002 * noise());
    frame.spot_sigma_mm = 0.002;
  }
  frames.push_back(std::move(frame));
}

void SyntheticRun::follow(int unit, int entity) {
  const dieline::Entity& e = dieline.entities[static_cast<std::size_t>(entity)];
  const double length_mm = dieline::lengthOf(e.curve);
  const std::size_t begin = evidence.spot.frames.size();
  bool was_lit = false;
  for (double s = 0.5 * kCut_mm_s * kPeriod_s; s < length_mm; s += kCut_mm_s * kPeriod_s) {
    const bool lit = e.process != dieline::Process::kPerforation || std::fmod(s, 4.0) <= 3.0;
    const double now_s = kPeriod_s * static_cast<double>(evidence.spot.frames.size());
    if (lit && !was_lit) evidence.gates.push_back({now_s - 0.5 * kPeriod_s, 0.0});
    addFrame(lit, unit, dieline::pointAt(e.curve, s / length_mm));
    if (lit) evidence.gates.back().off_s = now_s + 0.5 * kPeriod_s;
    was_lit = lit;
  }
  stretches_.push_back({unit, entity, begin, evidence.spot.frames.size()});
}

void SyntheticRun::addFrames() {
  for (int i = 0; i < 5; ++i) addFrame(false, 0, {});
  for (int unit = 0; unit < evidence.print.units; ++unit) {
    for (const dieline::Entity& entity : dieline.entities) {
      if (entity.process == dieline::Process::kIgnore) continue;
      follow(unit, entity.id);
      // The outline is one chain with the beam on; before the rest the beam jumps.
      if (entity.id < kLeft) continue;
      for (int i = 0; i < 20; ++i) addFrame(false, unit, {});
    }
  }
}

void SyntheticRun::followAgain(int unit, int entity) {
  follow(unit, entity);
  for (int i = 0; i < 5; ++i) addFrame(false, unit, {});
}

std::vector<std::pair<double, double>> SyntheticRun::cutsOf(double cut_mm, double bridge_mm) {
  std::vector<std::pair<double, double>> cuts;
  for (double at_mm = 0.0; at_mm < kPerforation_mm; at_mm += cut_mm + bridge_mm)
    cuts.emplace_back(at_mm, std::min(at_mm + cut_mm, kPerforation_mm));
  return cuts;
}

void SyntheticRun::perforate(int unit, const std::vector<std::pair<double, double>>& cuts_mm) {
  const auto lightAt = [&](double station_mm) {
    double open_mm = 0.0;
    for (const auto& [from_mm, to_mm] : cuts_mm) {
      open_mm += std::max(0.0, std::min(to_mm, station_mm + vision::kWindowHalfMm) -
                                   std::max(from_mm, station_mm - vision::kWindowHalfMm));
    }
    return std::min(1.0, open_mm / (2.0 * vision::kWindowHalfMm));
  };
  vision::EntityKerf& line = kerf(unit, kPerforationLine);
  line.light.clear();
  for (double at_mm = 0.0; at_mm <= kPerforation_mm; at_mm += 0.1)
    line.light.push_back({at_mm, lightAt(at_mm), false});
  for (vision::Caliper& c : line.calipers) {
    c.brightness = lightAt(c.station_mm);
    c.found = c.brightness > 0.15;
    if (!c.found) {
      c.brightness = 0.0;
      c.offset_mm = c.width_mm = c.sigma_mm = c.width_sigma_mm = std::numeric_limits<double>::quiet_NaN();
    } else if (!std::isfinite(c.offset_mm)) {
      c.offset_mm = 0.0;
      c.width_mm = 0.21;
      c.sigma_mm = c.width_sigma_mm = kNoise_mm;
    }
  }
}

vision::EntityKerf& SyntheticRun::kerf(int unit, int entity) {
  auto& all = evidence.kerf.entities;
  return *std::find_if(all.begin(), all.end(),
                       [&](const vision::EntityKerf& k) { return k.unit == unit && k.entity == entity; });
}

void SyntheticRun::shiftSpot(int unit, int entity, const std::function<Eigen::Vector2d(double)>& shift_mm) {
  for (const Stretch& s : stretches_) {
    if (s.unit != unit || s.entity != entity) continue;
    for (std::size_t i = s.begin; i < s.end; ++i) {
      vision::FrameMeasurement& frame = evidence.spot.frames[i];
      if (frame.spot_W_mm) *frame.spot_W_mm += shift_mm(frame.mid_s - evidence.spot.frames[s.begin].mid_s);
    }
  }
}

std::size_t SyntheticRun::frameAt(double time_s) const {
  const auto& frames = evidence.spot.frames;
  return static_cast<std::size_t>(
      std::find_if(frames.begin(), frames.end(), [&](const auto& f) { return f.mid_s >= time_s; }) -
      frames.begin());
}

const Check& checkOf(const InspectionResult& result, std::string_view name) {
  const auto found = std::find_if(result.checks.begin(), result.checks.end(),
                                  [&](const Check& c) { return c.name == name; });
  if (found == result.checks.end()) throw std::out_of_range("no check named " + std::string(name));
  return *found;
}

const Unjudged& unjudgedOf(const InspectionResult& result, std::string_view name) {
  const auto found = std::ranges::find(result.unjudged, name, &Unjudged::name);
  if (found == result.unjudged.end()) throw std::out_of_range("not among the unjudged: " + std::string(name));
  return *found;
}

bool hasCheck(const InspectionResult& result, std::string_view name) {
  return std::any_of(result.checks.begin(), result.checks.end(),
                     [&](const Check& c) { return c.name == name; });
}

}  // namespace kerfbench::inspect::testing
