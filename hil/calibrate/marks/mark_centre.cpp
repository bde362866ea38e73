// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_centre.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "hil/dieline/geometry.h"
#include "twin/base/statistics.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kEnd_mm = 0.3;            // Part of a kerf at its end that is not line.
constexpr std::size_t kLeastReadings = 4;  // Least readings of an arm.
constexpr double kOutlier = 5.0;           // Distance of an outlier, in sigmas.
constexpr double kLeastGood = 0.7;         // Least share of readings that are no outliers.
constexpr double kWildest_mm = 0.02;       // Largest RMS about the parabola.

struct Reading {
  double along_mm{};
  double offset_mm{};
  double noise_mm{};   ///< Noise of this stroke alone.
  double steady_mm{};  ///< In common with its neighbours.
  double width_mm{};
};

Vector2d leftOf(const Vector2d& along) { return {-along.y(), along.x()}; }
Vector3d terms(double t) { return {1.0, t, t * t}; }

/// Offset from the line as a parabola, and its covariance.
struct Parabola {
  Vector3d coefficients{Vector3d::Zero()};
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};
  double steady_mm{};
  double width_mm{};

  [[nodiscard]] double at(double t) const { return coefficients.dot(terms(t)); }
  [[nodiscard]] double slope(double t) const { return coefficients[1] + 2.0 * coefficients[2] * t; }
  [[nodiscard]] double variance(double t) const {
    return terms(t).dot(covariance * terms(t)) + steady_mm * steady_mm;
  }
};

/// False where an arm has too few readings.
bool addReadings(const vision::EntityKerf& kerf, double from_mm, std::vector<Reading>& readings) {
  const double length_mm = kerf.calipers.empty() ? 0.0 : kerf.calipers.back().station_mm;
  std::size_t count = 0;
  for (const vision::Caliper& c : kerf.calipers) {
    const bool usable = c.found && !c.near_joint && std::isfinite(c.sigma_mm);
    if (!usable || c.station_mm < kEnd_mm || c.station_mm > length_mm - kEnd_mm) continue;
    const double own = c.sigma_mm * c.sigma_mm - c.steady_sigma_mm * c.steady_sigma_mm;
    readings.push_back({from_mm + c.station_mm, c.offset_mm, std::sqrt(std::max(own, 1e-12)),
                        c.steady_sigma_mm, c.width_mm});
    ++count;
  }
  return count >= kLeastReadings;
}

std::optional<Parabola> fitOnce(const std::vector<Reading>& readings) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Reading& r : readings) {
    const double weight = 1.0 / (r.noise_mm * r.noise_mm);
    normal += weight * terms(r.along_mm) * terms(r.along_mm).transpose();
    right += weight * r.offset_mm * terms(r.along_mm);
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
  Parabola parabola;
  parabola.coefficients = solver.solve(right);
  parabola.covariance = solver.solve(Eigen::Matrix3d::Identity());
  return parabola;
}

/// Takes out readings that something else has spoilt: a scratch that crosses an arm.
void dropOutliers(const Parabola& parabola, std::vector<Reading>& readings) {
  std::vector<double> sizes;
  for (const Reading& r : readings) sizes.push_back(std::abs(r.offset_mm - parabola.at(r.along_mm)));
  const double scatter_mm = kMadToSigma * upperMedianOf(sizes);
  std::size_t i = 0;
  std::erase_if(readings,
                [&](const Reading& r) { return sizes[i++] > kOutlier * std::max(scatter_mm, r.noise_mm); });
}

std::optional<Parabola> fitRobust(std::vector<Reading> readings) {
  const std::size_t all = readings.size();
  for (int round = 0; round < 3; ++round) {
    const auto parabola = fitOnce(readings);
    if (!parabola) return std::nullopt;
    dropOutliers(*parabola, readings);
    if (static_cast<double>(readings.size()) < kLeastGood * static_cast<double>(all)) return std::nullopt;
  }
  auto parabola = fitOnce(readings);
  if (!parabola) return std::nullopt;
  double chi2 = 0.0;
  double squares = 0.0;
  const auto n = static_cast<double>(readings.size());
  for (const Reading& r : readings) {
    const double residual = r.offset_mm - parabola->at(r.along_mm);
    squares += residual * residual / n;
    chi2 += residual * residual / (r.noise_mm * r.noise_mm);
    parabola->steady_mm += r.steady_mm / n;
    parabola->width_mm += r.width_mm / n;
  }
  if (std::sqrt(squares) > kWildest_mm) return std::nullopt;
  // What the readings scatter beyond their noise, rough edges or a line that winds, is believed.
  parabola->covariance *= std::max(1.0, chi2 / (n - 3.0));
  return parabola;
}

}  // namespace

std::array<ArmLine, 2> armLines(const Cross& cross, const vision::PlaneMotion& X_TS) {
  const Matrix2d R_ST = X_TS.rotation().transpose();
  std::array<ArmLine, 2> lines;
  for (std::size_t k = 0; k < 2; ++k) {
    const Stroke& ahead = cross.arms.at(k);
    const Stroke& behind = cross.arms.at(k + 2);
    ArmLine& line = lines.at(k);
    line.p_mm = X_TS.inverse(0.5 * (ahead.p_T_mm + behind.p_T_mm));
    const Vector2d way = R_ST * (ahead.p_T_mm - behind.p_T_mm);
    line.along = way.normalized();
    const double middle_mm = 0.5 * way.norm();
    const double ahead_mm = ahead.half_mm.norm() - 0.5 * ahead.width_mm;
    const double behind_mm = behind.half_mm.norm() - 0.5 * behind.width_mm;
    line.ends_mm = {-middle_mm - behind_mm, -middle_mm + behind_mm, middle_mm - ahead_mm,
                    middle_mm + ahead_mm};
  }
  return lines;
}

std::vector<dieline::Curve> armCurves(const std::array<ArmLine, 2>& lines) {
  std::vector<dieline::Curve> curves;
  for (const ArmLine& line : lines) {
    for (const std::size_t arm : {0U, 2U}) {
      curves.emplace_back(dieline::LineCurve{line.p_mm + line.ends_mm.at(arm) * line.along,
                                             line.p_mm + line.ends_mm.at(arm + 1) * line.along});
    }
  }
  return curves;
}

std::variant<MarkCentre, std::string> centreOf(const std::array<ArmLine, 2>& lines,
                                               const std::array<const vision::EntityKerf*, 4>& arms) {
  std::array<Parabola, 2> parabolas;
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<Reading> readings;
    const bool behind = addReadings(*arms.at(2 * k), lines.at(k).ends_mm[0], readings);
    const bool ahead = addReadings(*arms.at(2 * k + 1), lines.at(k).ends_mm[2], readings);
    if (!behind || !ahead) return "has an arm that cannot be measured";
    const auto parabola = fitRobust(std::move(readings));
    if (!parabola) return "has arms that are no straight lines";
    parabolas.at(k) = *parabola;
  }
  // From the crossing of the tangents to that of the parabolas.
  Vector2d t = Vector2d::Zero();
  Matrix2d normals;
  Vector2d p_mm = lines[0].p_mm;
  for (int round = 0; round < 6; ++round) {
    Vector2d miss;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const ArmLine& line = lines.at(k);
      t[row] = (p_mm - line.p_mm).dot(line.along);
      const Vector2d left = leftOf(line.along);
      miss[row] = parabolas.at(k).at(t[row]) - (p_mm - line.p_mm).dot(left);
      normals.row(row) = (left - parabolas.at(k).slope(t[row]) * line.along).transpose();
    }
    p_mm += normals.inverse() * miss;
  }
  MarkCentre centre;
  centre.p_S_mm = p_mm;
  const Matrix2d spread = normals.inverse();
  const Vector2d variance(parabolas[0].variance(t[0]), parabolas[1].variance(t[1]));
  centre.covariance = spread * variance.asDiagonal() * spread.transpose();
  centre.width_mm = 0.5 * (parabolas[0].width_mm + parabolas[1].width_mm);
  if (!centre.p_S_mm.allFinite() || !centre.covariance.allFinite())
    return "has arms that are no straight lines";
  return centre;
}

}  // namespace kerfbench::calibrate
