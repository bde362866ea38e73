// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/calibrate/head/campaign.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "firmware_under_test/planner/head/correction.h"
#include "hil/calibrate/head/correction_table.h"
#include "hil/calibrate/tables/csv_table.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate::test {
namespace {

using Eigen::Vector2d;

constexpr int kPlaces = 400;
constexpr double kOffRow_mm = 0.1;                // Largest displacement from a row; eight steps and more.
constexpr double kEllipse95 = 5.991464547107979;  // Quantile of chi-square with two degrees of freedom.

enum Stream : std::uint64_t { kNoise = 1, kMissing, kFalse, kFalseKind, kFalseWay, kWhere, kOffRow };

Vector2d shareOf(const Eigen::AlignedBox2d& box, double u, double v) {
  return box.min() + Vector2d(u, v).cwiseProduct(box.sizes());
}

Vector2d noiseOf(const MarkQuality& q, std::uint64_t seed, std::uint64_t index) {
  const CounterRandom random(seed, kNoise);
  const double a = random.normal(2 * index), b = random.normal(2 * index + 1);
  return q.sigma_mm * Vector2d(a, q.correlation * a + std::sqrt(1.0 - q.correlation * q.correlation) * b);
}

/// Displacement from the row. Marks are made at rest here; in even rows they would share the rounding to
/// whole steps.
Vector2d offRow(std::uint64_t seed, std::uint64_t index) {
  const CounterRandom random(seed, kOffRow);
  return kOffRow_mm *
         Vector2d(2.0 * random.uniform(2 * index) - 1.0, 2.0 * random.uniform(2 * index + 1) - 1.0);
}

void spoil(MarkedSheet& sheet, const MarkQuality& quality, std::uint64_t seed) {
  const CounterRandom is_false(seed, kFalse), kind(seed, kFalseKind), way(seed, kFalseWay),
      is_missing(seed, kMissing);
  for (std::size_t i = 0; i < sheet.seen.size(); ++i) {
    if (is_false.uniform(i) >= quality.false_share) continue;
    if (kind.uniform(2 * i) < 0.5) {
      const auto other =
          static_cast<std::size_t>(kind.uniform(2 * i + 1) * static_cast<double>(sheet.seen.size()));
      std::swap(sheet.seen[i].p_mm, sheet.seen[other].p_mm);
    } else {
      const double off_mm = 0.02 * std::pow(1000.0, way.uniform(2 * i));
      const double angle = 2.0 * std::numbers::pi * way.uniform(2 * i + 1);
      sheet.seen[i].p_mm += off_mm * Vector2d(std::cos(angle), std::sin(angle));
    }
  }
  std::size_t index = 0;
  std::erase_if(sheet.seen,
                [&](const SeenMark&) { return is_missing.uniform(index++) < quality.missing_share; });
}

/// Places for verification: three quarters anywhere, an eighth on the rim, an eighth in the middle of the
/// table's cells.
std::vector<Vector2d> placesToVerify(const Eigen::AlignedBox2d& field, const AimGrid& grid,
                                     std::uint64_t seed) {
  const CounterRandom where(seed, kWhere);
  std::vector<Vector2d> places;
  for (std::uint64_t i = 0; i < kPlaces; ++i) {
    const double u = where.uniform(3 * i), v = where.uniform(3 * i + 1), kind = where.uniform(3 * i + 2);
    Vector2d p = shareOf(field, u, v);
    if (kind < 0.125) {
      const double side = kind < 0.0625 ? 0.0 : 1.0;
      p = i % 2 == 0 ? shareOf(field, u, side) : shareOf(field, side, v);
    } else if (kind < 0.25) {
      const Vector2d cell(grid.x_mm()[1] - grid.x_mm()[0], grid.y_mm()[1] - grid.y_mm()[0]);
      const Vector2d at = ((p - grid.area_W_mm().min()).cwiseQuotient(cell)).array().floor() + 0.5;
      p = (grid.area_W_mm().min() + at.cwiseProduct(cell)).cwiseMax(field.min()).cwiseMin(field.max());
    }
    places.push_back(p);
  }
  return places;
}

Verification verify(const SimulatedHead& head, const HeadFit& fit, const AimGrid& grid, std::uint64_t seed) {
  const planner::CorrectionTable table = planner::CorrectionTable::parse(csvTable(grid), "table");
  Verification v;
  double sum2 = 0.0;
  for (const Vector2d& p : placesToVerify(head.field_W_mm(), grid, seed)) {
    const double error = (head.spotFor(p + table.at(p).d, true) - p).norm();
    v.most_mm = std::max(v.most_mm, error);
    sum2 += error * error;
    const Vector2d aim = fit.aimFor(p).value();
    const Vector2d exact = head.spotFor(aim, false) - p;
    const Eigen::Matrix2d covariance = fit.covarianceAt_mm2(aim).value();
    v.covered += exact.dot(covariance.inverse() * exact) <= kEllipse95 ? 1 : 0;
    v.largest_sigma_mm = std::max(v.largest_sigma_mm, std::sqrt(0.5 * covariance.trace()));
    ++v.places;
  }
  v.rms_mm = std::sqrt(sum2 / static_cast<double>(v.places));
  return v;
}

}  // namespace

MarkedSheet mark(const SimulatedHead& head, int n, int first_id, const HeadFit* fit,
                 const MarkQuality& quality, std::uint64_t seed) {
  MarkedSheet sheet;
  Eigen::Matrix2d covariance;
  covariance << 1.0, quality.correlation, quality.correlation, 1.0;
  covariance *= quality.sigma_mm * quality.sigma_mm;
  const Eigen::AlignedBox2d inner(head.field_W_mm().min() + Vector2d::Constant(kOffRow_mm),
                                  head.field_W_mm().max() - Vector2d::Constant(kOffRow_mm));
  for (int i = 0; i < n * n; ++i) {
    const int column = i % n;
    const int row = i / n;
    const Vector2d wanted = shareOf(inner, 1.0 * column / (n - 1), 1.0 * row / (n - 1)) +
                            offRow(seed, static_cast<std::uint64_t>(first_id + i));
    const Vector2d aim = fit != nullptr ? fit->aimFor(wanted).value() : wanted;
    const int id = first_id + i;
    sheet.aimed.push_back({id, aim});
    const Vector2d place = head.spotFor(aim, true) + noiseOf(quality, seed, static_cast<std::uint64_t>(id));
    sheet.seen.push_back({id, place, covariance});
  }
  spoil(sheet, quality, seed * 1000003 + static_cast<std::uint64_t>(first_id));
  return sheet;
}

CampaignResult calibrate(const SimulatedHead& head, const MarkQuality& quality, std::uint64_t seed,
                         std::optional<double> unmodelled_share) {
  CampaignResult result;
  for (const Vector2d& share :
       {Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1), Vector2d(1, 1), Vector2d(0.5, 0.5)}) {
    const Vector2d p = shareOf(head.field_W_mm(), share.x(), share.y());
    result.raw_mm = std::max(result.raw_mm, (head.spotFor(p, true) - p).norm());
  }
  HeadFitOptions options;
  options.field_W_mm = head.field_W_mm();
  options.tolerances.unmodelled_share = unmodelled_share.value_or(head.unmodelledShare());
  std::vector<HeadObservation> all;
  std::optional<HeadFit> fit;
  int first_id = 0;
  for (const int n : {3, 9, 17}) {
    const MarkedSheet sheet = mark(head, n, first_id, fit ? &*fit : nullptr, quality, seed);
    first_id += n * n;
    PairingLimits limits;
    // Four of nine marks may be missing: five are enough to begin with.
    if (n == 3) limits.missing_share = 0.45;
    const Pairing pairs = pairMarks(sheet.aimed, sheet.seen, limits);
    all.insert(all.end(), pairs.observations.begin(), pairs.observations.end());
    try {
      HeadFit next = fitHead(all, head.nominal(), head.design(), options);
      const auto table = correctionTable(next, {.field_W_mm = head.field_W_mm()});
      result.iterations.push_back(verify(head, next, table.grid, seed));
      result.nodes = static_cast<int>(table.grid.x_mm().size());
      fit.emplace(std::move(next));
    } catch (const HeadCalibrationError&) {
      if (n != 3) throw;
      // A refusal comes from nine marks with several false ones: the next sheet is marked with the head as it
      // is.
      ++result.refused;
      result.iterations.push_back({.most_mm = result.raw_mm});
    }
  }
  result.marks = all.size();
  result.rejected = fit->rejected();
  result.noise_ratio = fit->noiseRatio();
  result.surface = fit->surface().has_value();
  return result;
}

}  // namespace kerfbench::calibrate::test
