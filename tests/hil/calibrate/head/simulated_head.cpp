// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/calibrate/head/simulated_head.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "hil/calibrate/head/head_parameters.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate::test {
namespace {

constexpr double kShare = 0.6;  // Share of the tolerances.
constexpr double kSag_mm = 0.03;
constexpr double kCubic_rad = 100e-6;
constexpr double kWave_rad = 5e-6;
constexpr double kWaves = 2.0;  // Number of waves over the whole travel.

double sideOf(HeadKind kind) {
  switch (kind) {
    case HeadKind::kTwoMirror100:
      return 100.0;
    case HeadKind::kTwoMirror800:
      return 800.0;
    default:
      return 300.0;
  }
}

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed, 0x4ead) {}
  double operator()(double sigma) { return kShare * plain(sigma); }
  double plain(double sigma) { return sigma * random_.normal(next_++); }
  double share() { return random_.uniform(1000000 + next_++); }

 private:
  CounterRandom random_;
  std::uint64_t next_{};
};

twin::MirrorAlignment misaligned(const HeadTolerances& t, Draw& draw) {
  twin::MirrorAlignment m;
  m.axis_tilt_rad = {draw(t.axis_tilt_rad), draw(t.axis_tilt_rad)};
  m.surface_offset_mm = draw(t.surface_mm);
  m.zero_rad = draw(t.zero_rad);
  m.scale = 1.0 + draw(t.scale_share);
  return m;
}

}  // namespace

std::string nameOf(HeadKind kind) {
  switch (kind) {
    case HeadKind::kTwoMirror100:
      return "two-mirror 100";
    case HeadKind::kTwoMirror300:
      return "two-mirror 300";
    case HeadKind::kTwoMirror800:
      return "two-mirror 800";
    case HeadKind::kFTheta300:
      return "f-theta 300";
  }
  return "";
}

SimulatedHead::SimulatedHead(HeadKind kind, Beyond beyond, std::uint64_t seed) {
  const HeadTolerances t;
  Draw draw(seed);
  const double side_mm = sideOf(kind);
  const bool lens = kind == HeadKind::kFTheta300;
  field_W_mm_ = {Eigen::Vector2d::Constant(-0.5 * side_mm), Eigen::Vector2d::Constant(0.5 * side_mm)};
  design_.throw_mm = lens ? 430.0 : 1.1 * side_mm;  // Throw of fixtures/machines/f-theta-300.yaml.
  design_.mirror_spacing_mm = lens ? 40.0 : 10.0 + 0.04 * side_mm;
  nominal_.throw_mm = design_.throw_mm;
  nominal_.mirror_spacing_mm = design_.mirror_spacing_mm;
  nominal_.mirror_step_rad = lens ? 5e-6 : side_mm / 65536.0 / (2.0 * design_.throw_mm);  // 16 bits.
  most_angle_rad_ = 0.25 * side_mm / design_.throw_mm;

  head_.throw_mm = design_.throw_mm * (1.0 + draw(t.throw_share));
  head_.mirror_spacing_mm = design_.mirror_spacing_mm + draw(t.mirror_spacing_mm);
  head_.x = misaligned(t, draw);
  head_.y = misaligned(t, draw);
  if (lens) {
    const double focal_mm = 430.0;
    nominal_.focal_length_mm = focal_mm;
    design_.lens = LensDesign{focal_mm, 0.0, 0.0, 0.5};  // A data sheet states f alone.
    twin::LensDescription real;
    real.focal_length_mm = focal_mm * (1.0 + draw(t.focal_length_share));
    real.k1 = -0.02 + 0.2 * draw(t.lens_k1_1_rad2);
    real.k2 = 0.2 * draw(t.lens_k2_1_rad4);
    real.decentre_mm = {draw(t.lens_decentre_mm), draw(t.lens_decentre_mm)};
    real.tilt_rad = {draw(t.lens_tilt), draw(t.lens_tilt)};
    real.incidence_ratio = 0.6 + 0.3 * draw(t.lens_incidence);
    head_.lens = real;
  }
  beam_.offset_mm = {draw(t.beam_offset_mm), draw(t.beam_offset_mm)};
  beam_.tilt_rad = {draw(t.beam_tilt_rad), draw(t.beam_tilt_rad)};
  surface_.height_mm = draw(t.plane_height_mm);
  surface_.slope = {draw(t.plane_slope), draw(t.plane_slope)};
  const double reach_mm = lens ? nominal_.focal_length_mm : design_.throw_mm;
  if (beyond != Beyond::kNothing) {
    // The share is height times the slope of the beam at the rim.
    unmodelled_share_ = kSag_mm / reach_mm * 0.5;
    const double curvature_1_mm = 8.0 * kSag_mm / (side_mm * side_mm);
    surface_.curvature_1_mm = {draw.plain(curvature_1_mm), draw.plain(curvature_1_mm)};
  }
  if (beyond == Beyond::kAnalogue) {
    unmodelled_share_ = 2.0 * reach_mm * kCubic_rad / side_mm;
    cubic_rad_ = {draw.plain(kCubic_rad), draw.plain(kCubic_rad)};
    wave_rad_ = {draw.plain(kWave_rad), draw.plain(kWave_rad)};
    wave_phase_ = 2.0 * std::numbers::pi * Eigen::Vector2d(draw.share(), draw.share());
  }
  truth_.emplace_back(head_, beam_);
  board_.emplace_back(surface_);
}

void SimulatedHead::change(const Change& change) {
  change_ = change;
  surface_.height_mm += change.height_mm;
  board_.clear();
  board_.emplace_back(surface_);
}

Eigen::Vector2d SimulatedHead::spotFor(const Eigen::Vector2d& aim_W_mm, bool rounded) const {
  Eigen::Vector2d angles = nominal_.angles_rad(aim_W_mm);
  if (rounded) angles = (angles / nominal_.mirror_step_rad).array().round() * nominal_.mirror_step_rad;
  angles = angles.cwiseProduct(change_.gain) + change_.zero_rad;
  const Eigen::Array2d share = angles.array() / most_angle_rad_;
  angles.array() += cubic_rad_.array() * share.cube() +
                    wave_rad_.array() * (std::numbers::pi * kWaves * share + wave_phase_.array()).sin();
  const auto spot = truth_.front().spotAt(angles, Eigen::Vector2d::Zero(), board_.front(), 0.0);
  if (!spot) throw std::runtime_error("the simulated beam does not land");
  return Eigen::Rotation2Dd(change_.turn_rad) * spot->p_WQ_mm;
}

}  // namespace kerfbench::calibrate::test
