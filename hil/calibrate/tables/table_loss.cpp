// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/table_loss.h"

#include <cmath>

#include <fmt/format.h>

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

constexpr double kWhole = 1.0 - 1e-9;
constexpr std::size_t kPerCell = 8;  // Along the border.
constexpr std::size_t kInCell = 4;   // Parts of a cell's side.

class Comparison {
 public:
  Comparison(const AimGrid& original, const AimGrid& converted)
      : original_(original), converted_(converted) {}

  void look(const Vector2d& p_W_mm, AimDifference& into) {
    const auto was = original_.at_mm(p_W_mm);
    const auto is = converted_.at_mm(p_W_mm);
    if (!was || !is) {
      ++not_covered_;
      return;
    }
    const double off_um = 1000.0 * (*is - *was).norm();
    into.rms_um += off_um * off_um;
    ++into.places;
    if (into.places == 1 || off_um > into.max_um) {
      into.max_um = off_um;
      into.worst_W_mm = p_W_mm;
    }
  }
  [[nodiscard]] std::size_t notCovered() const { return not_covered_; }

 private:
  const AimGrid& original_;
  const AimGrid& converted_;
  std::size_t not_covered_{};
};

/// Each cell's side in `parts`, borders included once.
std::vector<double> parted(const std::vector<double>& places, std::size_t parts) {
  std::vector<double> all;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const std::vector<double> cell = evenly(places[i], places[i + 1], parts + 1);
    all.insert(all.end(), cell.begin(), cell.end() - 1);
  }
  all.push_back(places.back());
  return all;
}

std::vector<double> middles(const std::vector<double>& places) {
  std::vector<double> all;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) all.push_back(0.5 * (places[i] + places[i + 1]));
  return all;
}

void lookAtAll(Comparison& comparison, const std::vector<double>& x, const std::vector<double>& y,
               AimDifference& into) {
  for (const double py : y) {
    for (const double px : x) comparison.look({px, py}, into);
  }
}

std::string line(const char* name, const AimDifference& difference) {
  return fmt::format("{}: {:.3f} µm at most, at ({:.3f}, {:.3f}) mm; {:.3f} µm RMS of {} places\n", name,
                     difference.max_um, difference.worst_W_mm.x(), difference.worst_W_mm.y(),
                     difference.rms_um, difference.places);
}

}  // namespace

TableLoss tableLoss(const AimGrid& original, const AimGrid& converted) {
  TableLoss loss;
  Comparison comparison(original, converted);
  const std::vector<double>& x = converted.x_mm();
  const std::vector<double>& y = converted.y_mm();
  lookAtAll(comparison, x, y, loss.nodes);
  lookAtAll(comparison, middles(x), middles(y), loss.mid_cell);
  const std::vector<double> along_x = parted(x, kPerCell);
  const std::vector<double> along_y = parted(y, kPerCell);
  lookAtAll(comparison, along_x, {y.front(), y.back()}, loss.rim);
  lookAtAll(comparison, {x.front(), x.back()}, {along_y.begin() + 1, along_y.end() - 1}, loss.rim);
  lookAtAll(comparison, parted(x, kInCell), parted(y, kInCell), loss.anywhere);
  for (AimDifference* part : {&loss.nodes, &loss.mid_cell, &loss.rim, &loss.anywhere}) {
    if (part->places > 0) part->rms_um = std::sqrt(part->rms_um / static_cast<double>(part->places));
  }
  loss.not_covered = comparison.notCovered();
  const Eigen::AlignedBox2d whole = original.area_W_mm();
  loss.covered_share =
      whole.intersection(converted.area_W_mm()).sizes().cwiseMax(0.0).prod() / whole.volume();
  return loss;
}

std::string TableLoss::text() const {
  std::string all = line("nodes (rounding)", nodes) + line("middles of cells", mid_cell) + line("rim", rim) +
                    line("anywhere", anywhere);
  if (covered_share < kWhole)
    all += fmt::format("{:.1f} % of the original's area are covered\n", 100.0 * covered_share);
  if (not_covered > 0) all += fmt::format("{} places lie where the original says nothing\n", not_covered);
  return all;
}

}  // namespace kerfbench::calibrate
