// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/recognise.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/LU>

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2i;
using Eigen::Vector2d;

constexpr std::size_t kLeastSpots = 6;

Matrix2i matrix(int a, int b, int c, int d) {
  Matrix2i m;
  m << a, b, c, d;
  return m;
}

struct NamedMap {
  Matrix2i map;
  const char* places;
  const char* values;
};

const std::vector<NamedMap>& maps() {
  static const std::vector<NamedMap> kMaps{
      {matrix(1, 0, 0, 1), "as it is", "as they are"},
      {matrix(0, 1, 1, 0), "transposed", "exchanged, dx for dy"},
      {matrix(-1, 0, 0, 1), "mirrored in x", "of the wrong sign in dx"},
      {matrix(1, 0, 0, -1), "mirrored in y", "of the wrong sign in dy"},
      {matrix(-1, 0, 0, -1), "turned by 180°", "of the wrong sign"},
      {matrix(0, -1, 1, 0), "turned by 90°", "exchanged and of the wrong sign in dx"},
      {matrix(0, 1, -1, 0), "turned by -90°", "exchanged and of the wrong sign in dy"},
      {matrix(0, -1, -1, 0), "transposed and turned by 180°", "exchanged and of the wrong sign"}};
  return kMaps;
}

const NamedMap& named(const Matrix2i& map) {
  const auto found = std::ranges::find_if(maps(), [&](const NamedMap& m) { return m.map == map; });
  if (found == maps().end()) throw std::invalid_argument("a reading turns the axes onto themselves");
  return *found;
}

/// The table's value for a reading, at a place: d'(p) = V d(A⁻¹ p).
Vector2d valueOf(const AimGrid& grid, const TableReading& reading, const Vector2d& p) {
  const Vector2d at = reading.places.cast<double>().transpose() * p;  // A⁻¹ = Aᵀ.
  return reading.values.cast<double>() * *grid.at_mm(at);
}

Eigen::AlignedBox2d widened(const Eigen::AlignedBox2d& area, double share) {
  return {area.min() - share * area.sizes(), area.max() + share * area.sizes()};
}

/// Within reach, whichever way the places are turned.
bool reachable(const Eigen::AlignedBox2d& area, const Vector2d& spot) {
  return std::ranges::all_of(
      maps(), [&](const NamedMap& m) { return area.contains(m.map.cast<double>().transpose() * spot); });
}

void check(const RecogniseOptions& options) {
  const bool good = options.sigma_mm > 0.0 && std::isfinite(options.sigma_mm) && options.most_share > 0.0 &&
                    options.most_share < 1.0 && options.rival_margin > 0.0 && options.reach_share >= 0.0 &&
                    options.reach_share <= 1.0 && options.same_table_mm >= 0.0;
  if (!good) throw std::invalid_argument("sigma above 0, shares within 0 … 1, and limits not negative");
}

std::vector<UncorrectedSpot> usable(const AimGrid& grid, const std::vector<UncorrectedSpot>& spots,
                                    const RecogniseOptions& options) {
  const Eigen::AlignedBox2d area = widened(grid.area_W_mm(), options.reach_share);
  std::vector<UncorrectedSpot> good;
  for (const UncorrectedSpot& s : spots) {
    if (!s.aim_W_mm.allFinite() || !s.spot_W_mm.allFinite())
      throw std::invalid_argument("a spot is not finite");
    if (reachable(area, s.spot_W_mm)) good.push_back(s);
  }
  if (good.size() < kLeastSpots) {
    throw std::invalid_argument(fmt::format("{} of {} spots lie within reach of the table, {} are wanted",
                                            good.size(), spots.size(), kLeastSpots));
  }
  return good;
}

double rmsOf(const AimGrid& grid, const TableReading& reading, const std::vector<UncorrectedSpot>& spots) {
  double sum = 0.0;
  for (const UncorrectedSpot& s : spots)
    sum += (s.spot_W_mm + valueOf(grid, reading, s.spot_W_mm) - s.aim_W_mm).squaredNorm();
  return std::sqrt(sum / static_cast<double>(spots.size()));
}

/// Whether two readings are one within `limit_mm`, over all nodes that both cover.
bool sameTable(const AimGrid& grid, const TableReading& a, const TableReading& b, double limit_mm) {
  for (const double y : grid.y_mm()) {
    for (const double x : grid.x_mm()) {
      const Vector2d p(x, y);
      if (!reachable(grid.area_W_mm(), p)) continue;
      if ((valueOf(grid, a, p) - valueOf(grid, b, p)).norm() > limit_mm) return false;
    }
  }
  return true;
}

/// First the reading as it is, then those that only turn the file as a whole, then any.
int simplicity(const TableReading& r) {
  if (r == TableReading{}) return 0;
  return r.places == r.values || r.places == Matrix2i::Identity() || r.values == Matrix2i::Identity() ? 1 : 2;
}

class Judge {
 public:
  Judge(const AimGrid& grid, const RecogniseOptions& options, Recognition& result)
      : grid_(grid), options_(options), result_(result) {}

  void decide() {
    const double best_mm = result_.fits.front().rms_mm;
    const double limit_mm = std::max(options_.most_share * result_.error_rms_mm, 3.0 * options_.sigma_mm);
    result_.reading = simplest().reading;
    if (best_mm > limit_mm) {
      result_.verdict = Recognition::Verdict::kNoneFits;
      result_.text = fmt::format(
          "no reading fits: the best leaves {:.3f} mm RMS of {:.3f} mm that the spots are off, more than "
          "{:.3f} mm; "
          "the table is of another head, or the check is not without correction",
          best_mm, result_.error_rms_mm, limit_mm);
      return;
    }
    if (const ReadingFit* rival = rivalOf(result_.reading)) return tie(*rival);
    const bool as_read = result_.reading == TableReading{};
    result_.verdict = as_read ? Recognition::Verdict::kAsRead : Recognition::Verdict::kOtherwise;
    result_.text = fmt::format("{}: {:.3f} mm RMS are left of {:.3f} mm", result_.reading.text(),
                               fitOf(result_.reading), result_.error_rms_mm);
    if (!as_read) result_.text += fmt::format("; read as it is, {:.3f} mm", fitOf(TableReading{}));
  }

 private:
  /// Sum of squares less than this above the best's is no better than the best.
  [[nodiscard]] bool asGood(const ReadingFit& fit) const {
    const double n = static_cast<double>(result_.spots);
    const double best = n * result_.fits.front().rms_mm * result_.fits.front().rms_mm;
    const double variance = std::max(options_.sigma_mm * options_.sigma_mm, best / (2.0 * n));
    return n * fit.rms_mm * fit.rms_mm - best < options_.rival_margin * variance;
  }
  [[nodiscard]] const ReadingFit& simplest() const {
    const ReadingFit* found = &result_.fits.front();
    for (const ReadingFit& fit : result_.fits) {
      if (asGood(fit) && simplicity(fit.reading) < simplicity(found->reading)) found = &fit;
    }
    return *found;
  }
  /// One that fits as well and is another table.
  [[nodiscard]] const ReadingFit* rivalOf(const TableReading& reading) const {
    for (const ReadingFit& fit : result_.fits) {
      if (asGood(fit) && !(fit.reading == reading) &&
          !sameTable(grid_, fit.reading, reading, options_.same_table_mm))
        return &fit;
    }
    return nullptr;
  }
  [[nodiscard]] double fitOf(const TableReading& reading) const {
    return std::ranges::find_if(result_.fits, [&](const ReadingFit& f) { return f.reading == reading; })
        ->rms_mm;
  }
  void tie(const ReadingFit& rival) {
    result_.verdict = Recognition::Verdict::kUndecided;
    result_.text = fmt::format(
        "cannot be told: «{}» leaves {:.3f} mm RMS, «{}» {:.3f} mm, of {:.3f} mm that the spots are off; "
        "mark "
        "more points, far from the axes and the diagonals",
        result_.reading.text(), fitOf(result_.reading), rival.reading.text(), rival.rms_mm,
        result_.error_rms_mm);
  }

  const AimGrid& grid_;
  const RecogniseOptions& options_;
  Recognition& result_;
};

std::vector<double> negated(std::vector<double> places, bool negative) {
  if (!negative) return places;
  std::ranges::reverse(places);
  for (double& place : places) place = 0.0 - place;
  return places;
}

}  // namespace

std::string TableReading::text() const {
  const Matrix2i minus = -values;
  const Matrix2i identity = Matrix2i::Identity();
  if (places == identity && values == identity) return "the file is as it was read";
  if (places == identity && values == -identity) return "the sign is turned";
  if (places == values) return fmt::format("the file is {}", named(places).places);
  if (places == minus) return fmt::format("the file is {}, and its sign is turned", named(places).places);
  if (places == identity) return fmt::format("the values are {}", named(values).values);
  if (values == identity) return fmt::format("the order of the nodes is {}", named(places).places);
  return fmt::format("the order of the nodes is {}, the values are {}", named(places).places,
                     named(values).values);
}

std::vector<TableReading> allReadings() {
  std::vector<TableReading> all;
  for (const NamedMap& places : maps()) {
    for (const NamedMap& values : maps()) all.push_back({places.map, values.map});
  }
  return all;
}

AimGrid asRead(const AimGrid& grid, const TableReading& reading) {
  (void)named(reading.places);
  (void)named(reading.values);
  const bool exchanged = reading.places(0, 0) == 0;
  const std::vector<double> x =
      negated(exchanged ? grid.y_mm() : grid.x_mm(), reading.places.row(0).sum() < 0);
  const std::vector<double> y =
      negated(exchanged ? grid.x_mm() : grid.y_mm(), reading.places.row(1).sum() < 0);
  std::vector<Vector2d> d;
  for (const double py : y) {
    for (const double px : x) d.push_back(valueOf(grid, reading, {px, py}));
  }
  return {x, y, std::move(d), grid.between(), grid.outside()};
}

Recognition recognise(const AimGrid& grid, const std::vector<UncorrectedSpot>& spots,
                      const RecogniseOptions& options) {
  check(options);
  const std::vector<UncorrectedSpot> good = usable(grid, spots, options);
  const AimGrid wide = grid.with(grid.between(), Outside::kLinear);
  Recognition result;
  result.spots = good.size();
  double sum = 0.0;
  for (const UncorrectedSpot& s : good) sum += (s.spot_W_mm - s.aim_W_mm).squaredNorm();
  result.error_rms_mm = std::sqrt(sum / static_cast<double>(good.size()));
  for (const TableReading& reading : allReadings())
    result.fits.push_back({reading, rmsOf(wide, reading, good)});
  std::ranges::stable_sort(result.fits, {}, &ReadingFit::rms_mm);
  Judge(wide, options, result).decide();
  return result;
}

}  // namespace kerfbench::calibrate
