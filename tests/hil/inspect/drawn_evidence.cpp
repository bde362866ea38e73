// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/inspect/drawn_evidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/deviation/error_model.h"
#include "twin/base/random.h"

namespace kerfbench::inspect::testing {
namespace {

using Eigen::Vector2d;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed, 77) {}
  double normal() { return random_.normal(next_++); }
  double between(double low, double high) { return low + (high - low) * random_.uniform(2 * next_++); }

 private:
  CounterRandom random_;
  std::uint64_t next_{};
};

/// Shifts of the whole cut, waves, bumps, steps: where the kerf really lies.
class TrueShape {
 public:
  TrueShape(Dice& dice, std::uint64_t kind) : kind_(kind % 7) {
    size_mm_ = dice.between(0.004, 0.080);
    unit_ = dice.between(0, 1) < 0.5 ? 0 : 1;
    entity_ = std::min(static_cast<int>(dice.between(0, 7)), 6);
    at_ = dice.between(0.2, 0.8);
    length_mm_ = dice.between(1.5, 12.0);
    direction_ = dice.between(-std::numbers::pi, std::numbers::pi);
    rest_mm_ = dice.between(0.0, 0.004);
  }

  [[nodiscard]] double at(int unit, int entity, const dieline::Entity& line, const vision::Caliper& c) const {
    const Vector2d tangent = dieline::tangentAt(line.curve, c.u);
    const Vector2d normal(-tangent.y(), tangent.x());
    const Vector2d middle(30.0, 20.0);
    const bool chosen = unit == unit_ && entity == entity_;
    const double from_mm = c.station_mm - at_ * dieline::lengthOf(line.curve);
    // Every cut wanders a little.
    const double rest_mm = rest_mm_ * std::sin(0.4 * c.station_mm + entity);
    switch (kind_) {
      case 0:  // all shifted
        return rest_mm + size_mm_ * normal.dot(Vector2d(std::cos(direction_), std::sin(direction_)));
      case 1:  // one line
        return rest_mm + (chosen ? size_mm_ : 0.0);
      case 2:  // a bump
        return rest_mm + (chosen ? size_mm_ * std::exp(-0.5 * std::pow(4.0 * from_mm / length_mm_, 2)) : 0.0);
      case 3:  // a wave
        return rest_mm + (chosen ? size_mm_ * std::sin(2.0 * std::numbers::pi * from_mm / length_mm_) : 0.0);
      case 4:  // turned
        return rest_mm +
               size_mm_ / 36.0 * normal.dot(Vector2d(-(c.p_S_mm - middle).y(), (c.p_S_mm - middle).x()));
      case 5:  // scaled
        return rest_mm + size_mm_ / 30.0 * normal.dot(c.p_S_mm - middle);
      default:  // a step
        return rest_mm + (chosen && from_mm > 0.0 ? size_mm_ : 0.0);
    }
  }

 private:
  std::uint64_t kind_;
  double size_mm_, at_, length_mm_, direction_, rest_mm_;
  int unit_, entity_;
};

/// Noise along a line, sigma 1.
class Correlated {
 public:
  explicit Correlated(double q) : q_(q) {}
  double next(Dice& dice) {
    z_ = started_ ? q_ * z_ + std::sqrt(1.0 - q_ * q_) * dice.normal() : dice.normal();
    started_ = true;
    return z_;
  }

 private:
  double q_;
  double z_{};
  bool started_{};
};

/// An inspection table that stops a little beside where it should: each tile of 20 mm has its own error.
/// Every other sheet is seen in one piece.
class Table {
 public:
  explicit Table(std::uint64_t seed) : dice_(seed + 1'000'000), sigma_mm_(dice_.between(0.0004, 0.0012)) {
    if (seed % 2 == 0) sigma_mm_ = 0.0;
  }
  [[nodiscard]] double sigma_mm() const { return sigma_mm_; }
  /// Tells the caliper its tile.
  Vector2d errorAt(int unit, vision::Caliper& c) {
    constexpr double kTile_mm = 20.0;
    const Vector2d place = c.p_S_mm / kTile_mm;
    c.tile =
        100 * (50 + static_cast<int>(std::floor(place.y()))) + 50 + static_cast<int>(std::floor(place.x()));
    const auto known = errors_mm_.find({unit, c.tile});
    if (known != errors_mm_.end()) return known->second;
    const Vector2d error_mm = sigma_mm_ * Vector2d(dice_.normal(), dice_.normal());
    return errors_mm_[{unit, c.tile}] = error_mm;
  }

 private:
  Dice dice_;
  double sigma_mm_;
  std::map<std::pair<int, int>, Vector2d> errors_mm_;
};

}  // namespace

DrawnEvidence::DrawnEvidence(std::uint64_t seed) {
  Dice dice(seed);
  Evidence& evidence = run.evidence;
  const TrueShape shape(dice, seed);
  const double sigma_mm = dice.between(0.0003, 0.0012);
  const double correlation_mm = dice.between(0.05, 0.6);
  const double pose_mm = dice.between(0.0001, 0.0006);

  for (Eigen::Matrix<double, vision::CameraCalibration::kParameters, 1>& mode :
       evidence.kerf_calibration->error_modes)
    mode *= 3.0;
  std::vector<double> e_camera;
  for (std::size_t k = 0; k < evidence.kerf_calibration->error_modes.size(); ++k)
    e_camera.push_back(dice.normal());
  std::vector<Eigen::Vector3d> pose_error;
  for (vision::UnitPose& pose : evidence.kerf.units) {
    const Eigen::Vector3d sigma(pose_mm, pose_mm, pose_mm / 40.0);
    pose.covariance = sigma.cwiseAbs2().asDiagonal();
    pose_error.emplace_back(sigma.x() * dice.normal(), sigma.y() * dice.normal(), sigma.z() * dice.normal());
  }

  Table table(seed);
  evidence.kerf.table_sigma_mm = table.sigma_mm();

  double squares = 0.0;
  double readings = 0.0;
  for (vision::EntityKerf& kerf : evidence.kerf.entities) {
    const dieline::Entity& line = run.dieline.entities[static_cast<std::size_t>(kerf.entity)];
    const double pitch_mm = kerf.calipers[1].station_mm;
    Correlated noise(std::exp(-pitch_mm / correlation_mm));
    Correlated width_noise(std::exp(-pitch_mm / correlation_mm));
    double worst = 0.0;
    std::vector<double> widths;
    const double width_mm = dice.between(0.15, 0.25);
    const double steady_mm = dice.between(0.0, 0.0004);
    std::vector<double> steady_error_mm;
    for (Eigen::Index k = 0; k < ReadingLine::kLine; ++k)
      steady_error_mm.push_back(steady_mm * dice.normal());
    for (vision::Caliper& c : kerf.calipers) {
      const double z = noise.next(dice);
      const double z_width = width_noise.next(dice);
      if (!c.found) continue;
      const double truth_mm = shape.at(kerf.unit, kerf.entity, line, c);
      const Vector2d tangent = dieline::tangentAt(line.curve, c.u);
      const Vector2d normal(-tangent.y(), tangent.x());
      const Eigen::Vector3d& pose = pose_error[static_cast<std::size_t>(kerf.unit)];
      Vector2d shift = pose.head<2>() + pose.z() * Vector2d(-c.p_S_mm.y(), c.p_S_mm.x());
      for (std::size_t k = 0; k < e_camera.size(); ++k)
        shift += e_camera[k] * evidence.kerf_calibration->mapError(k, c.p_V_mm);
      shift += table.errorAt(kerf.unit, c);
      const double noise_mm = sigma_mm * (1.0 + 0.3 * std::sin(0.2 * c.station_mm));
      c.steady_sigma_mm = steady_mm;
      c.sigma_mm = std::hypot(noise_mm, steady_mm);
      c.offset_mm = truth_mm + normal.dot(shift) + noise_mm * z +
                    steady_error_mm[static_cast<std::size_t>(ReadingLine::directionOf(tangent))];
      c.width_sigma_mm = 2.0 * sigma_mm;
      const double true_width_mm = width_mm + 0.002 * std::sin(0.1 * c.station_mm);
      c.width_mm = true_width_mm + c.width_sigma_mm * z_width;
      if (!judgesOffset(c)) continue;
      worst = std::max(worst, std::abs(truth_mm));
      squares += truth_mm * truth_mm;
      readings += 1.0;
      widths.push_back(true_width_mm);
    }
    entity_worst_mm.push_back(worst);
    entity_width_mm.push_back(std::accumulate(widths.begin(), widths.end(), 0.0) /
                              static_cast<double>(widths.size()));
    worst_mm = std::max(worst_mm, worst);
  }
  rms_mm = std::sqrt(squares / readings);

  // Twelve cuts, one after the other, each on a line across the belt.
  const double frame_sigma_mm = dice.between(0.001, 0.004);
  const double q = dice.between(0.0, 0.7);
  evidence.spot.frames.clear();
  for (int cut = 0; cut < 12; ++cut) {
    const std::size_t begin = lit.frames.size();
    const int frames = static_cast<int>(dice.between(25, 160));
    const double drift = dice.between(-0.03, 0.03);
    const double n_x = dice.between(0.8, 1.0);
    Correlated noise(q);
    Eigen::VectorXd time(frames);
    Eigen::VectorXd truth(frames);
    for (int i = 0; i < frames; ++i) {
      const double share = i / (frames - 1.0);
      truth[i] = drift * share + 0.003 * std::sin(5.0 * share);
      LitFrame frame;
      frame.frame = evidence.spot.frames.size();
      time[i] = frame.time_s = 1e-3 * static_cast<double>(frame.frame);
      frame.sigma_mm = frame_sigma_mm;
      frame.entity = kCreaseLine;
      frame.n_x = n_x;
      frame.deviation_mm = n_x * truth[i] + frame.sigma_mm * noise.next(dice);
      lit.frames.push_back(frame);
      vision::FrameMeasurement seen;
      seen.spot_W_mm = Vector2d(-20.0 + 40.0 * share, 0.0);
      evidence.spot.frames.push_back(seen);
    }
    lit.runs.push_back({begin, lit.frames.size()});
    const Eigen::VectorXd t = time.array() - time.mean();
    drift_mm.push_back(t.dot(truth) / t.squaredNorm() * (time[frames - 1] - time[0]));
    worst_drift_mm = std::max(worst_drift_mm, std::abs(drift_mm.back()));
  }
}

void Coverage::Count::add(const Quantity& stated, double truth) {
  ++cases;
  inside += std::abs(truth - stated.value) <= stated.U + 1e-12 ? 1 : 0;
}

Coverage measureCoverage(std::uint64_t first, int cases) {
  Coverage coverage;
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const DrawnEvidence drawn(seed);
    const Evidence& evidence = drawn.run.evidence;
    const DeviationResult deviations = checks::measureLines(evidence, drawn.run.limits);
    const auto entities = checks::measureEntities(evidence, drawn.run.limits, deviations);
    const Check path = checks::pathCheck(evidence, drawn.run.limits, deviations);
    const std::size_t one = seed % entities.size();
    coverage.worst.add({path.value, path.u}, drawn.worst_mm);
    coverage.entity_worst.add({std::abs(entities[one].worst_mm), entities[one].worst_U_mm},
                              drawn.entity_worst_mm[one]);
    coverage.rms.add(deviations.all.rms, drawn.rms_mm);
    coverage.width.add({entities[one].width_mm, entities[one].width_U_mm}, drawn.entity_width_mm[one]);
    coverage.largest_U_mm = std::max(coverage.largest_U_mm, path.u);
    coverage.budget_ratio.push_back(deviations.budget.analytic_U / deviations.budget.monte_carlo_U);
    coverage.good += drawn.worst_mm <= 0.040 ? 1 : 0;
    coverage.bad += drawn.worst_mm >= 0.055 ? 1 : 0;
    coverage.wrong_pass += drawn.worst_mm >= 0.055 && path.verdict == Verdict::kPass ? 1 : 0;
    coverage.wrong_fail += drawn.worst_mm <= 0.040 && path.verdict == Verdict::kFail ? 1 : 0;
    coverage.unproven_good += drawn.worst_mm <= 0.040 && path.verdict == Verdict::kNotProven ? 1 : 0;

    const checks::Stillness still = checks::measureCuts(evidence, drawn.lit, drawn.run.limits);
    const std::size_t cut = seed % still.cuts.size();
    coverage.drift.add({still.cuts[cut].drift_mm, 2.0 * still.cuts[cut].drift_sigma_mm}, drawn.drift_mm[cut]);
    coverage.worst_drift.add(still.worst_drift_mm, drawn.worst_drift_mm);
  }
  std::sort(coverage.budget_ratio.begin(), coverage.budget_ratio.end());
  return coverage;
}

}  // namespace kerfbench::inspect::testing
