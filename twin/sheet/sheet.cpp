// SPDX-License-Identifier: Apache-2.0
#include "twin/sheet/sheet.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "twin/sheet/cubic_spline.h"

namespace kerfbench::twin {
namespace {

constexpr double kReachRadii = 2.4;
constexpr double kMinVariance =
    0.25;  // Of a laid-down bell, in nodes²; below it the samples no longer add up evenly.
constexpr double kMaxStepRadii =
    0.2;  // Leaves 2e-3 of the peak at the ends of a long move; along it there is no ripple.
constexpr double kMinRadiusMm = 0.03;  // For the length of a step only.
constexpr double kFarMm = 1e6;

int floorDiv(int value, int divisor) {
  const int quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

/// The 1/e² radius, in nodes, of the bell that the spline spreads to one of `radius_mm`.
double laidRadius(double radius_mm) {
  const double radius = radius_mm / Sheet::kCellMm;
  return 2.0 * std::sqrt(std::max(0.25 * radius * radius - kSplineVariance, kMinVariance));
}

/// The Gaussian exp(-2 x²/w²) at nodes first, first + 1, …; returns the sum. By recurrence: the ratio of
/// neighbours itself changes by a constant factor, so three exponentials are enough for any number of nodes.
double gaussianProfile(double centre_nodes, double radius_nodes, int first, std::vector<float>& out) {
  const double a = 2.0 / (radius_nodes * radius_nodes);
  const double x = first - centre_nodes;
  double value = std::exp(-a * x * x);
  double ratio = std::exp(-a * (2.0 * x + 1.0));
  const double ratio_change = std::exp(-2.0 * a);
  double sum = 0.0;
  for (float& node : out) {
    // Smaller ones would be denormal once multiplied, and slow.
    const double kept = value < 1e-12 ? 0.0 : value;
    node = static_cast<float>(kept);
    sum += kept;
    value *= ratio;
    ratio *= ratio_change;
  }
  return sum;
}

bool inRange(const Footprint& footprint) {
  const auto radiusFits = [](double radius_mm) { return radius_mm > 0.0 && radius_mm <= 100.0; };
  return std::abs(footprint.p_SQ_mm.x()) <= kFarMm && std::abs(footprint.p_SQ_mm.y()) <= kFarMm &&
         radiusFits(footprint.radius_x_mm) && radiusFits(footprint.radius_y_mm);
}

}  // namespace

Sheet::Sheet(const BoardDescription& board) : board_(board) {
  std::string faults;
  const auto require = [&faults](bool fine, const char* rule) {
    if (!fine) faults += (faults.empty() ? "board: " : "; ") + std::string(rule);
  };
  require(board.thickness_mm > 0.0 && std::isfinite(board.thickness_mm), "thickness_mm must be > 0");
  require(board.cut_fluence_j_mm2 > 0.0 && std::isfinite(board.cut_fluence_j_mm2),
          "cut_fluence_j_mm2 must be > 0");
  require(board.transmission > 0.0 && board.transmission < 1.0, "transmission must be in (0, 1)");
  require(board.print_transmission > 0.0 && board.print_transmission <= board.transmission,
          "print_transmission must be in (0, transmission]");
  if (!faults.empty()) throw std::invalid_argument(faults);
}

void Sheet::burn(const Footprint& from, const Footprint& to, double energy_j) {
  if (energy_j == 0.0) return;
  if (!(energy_j > 0.0 && std::isfinite(energy_j)) || !inRange(from) || !inRange(to)) {
    throw std::invalid_argument("Sheet::burn: energy, place or radius out of range");
  }
  const double smallest_mm =
      std::max(std::min({from.radius_x_mm, from.radius_y_mm, to.radius_x_mm, to.radius_y_mm}), kMinRadiusMm);
  const double length_mm = (to.p_SQ_mm - from.p_SQ_mm).norm();
  const int parts = std::max(1, static_cast<int>(std::ceil(length_mm / (kMaxStepRadii * smallest_mm))));
  for (int part = 0; part < parts; ++part) {
    const double u = (part + 0.5) / parts;
    deposit({from.p_SQ_mm + u * (to.p_SQ_mm - from.p_SQ_mm),
             from.radius_x_mm + u * (to.radius_x_mm - from.radius_x_mm),
             from.radius_y_mm + u * (to.radius_y_mm - from.radius_y_mm)},
            energy_j / parts);
  }
}

void Sheet::deposit(const Footprint& footprint, double energy_j) {
  const double x = footprint.p_SQ_mm.x() / kCellMm;
  const double y = footprint.p_SQ_mm.y() / kCellMm;
  const double radius_x = laidRadius(footprint.radius_x_mm);
  const double radius_y = laidRadius(footprint.radius_y_mm);
  // Columns in whole quads, which never straddle two tiles.
  const int first_x = 4 * static_cast<int>(std::floor((x - kReachRadii * radius_x) / 4.0));
  const int last_x = 4 * static_cast<int>(std::floor((x + kReachRadii * radius_x) / 4.0)) + 4;
  const int first_y = static_cast<int>(std::ceil(y - kReachRadii * radius_y));
  const int last_y = static_cast<int>(std::floor(y + kReachRadii * radius_y)) + 1;
  profile_x_.resize(static_cast<std::size_t>(last_x - first_x));
  profile_y_.resize(static_cast<std::size_t>(std::max(last_y - first_y, 1)));
  const double sum_x = gaussianProfile(x, radius_x, first_x, profile_x_);
  const double sum_y = gaussianProfile(y, radius_y, first_y, profile_y_);
  const double scale = energy_j / (kCellMm * kCellMm * sum_x * sum_y);
  for (float& node : profile_y_) node = static_cast<float>(node * scale);

  for (int y_begin = first_y; y_begin < last_y;) {
    const int tile_y = floorDiv(y_begin, kTileNodes);
    const int y_end = std::min(last_y, (tile_y + 1) * kTileNodes);
    for (int x_begin = first_x; x_begin < last_x;) {
      const int tile_x = floorDiv(x_begin, kTileNodes);
      const int x_end = std::min(last_x, (tile_x + 1) * kTileNodes);
      float* nodes = tileFor(tile_x, tile_y).j_mm2.data() + (x_begin - tile_x * kTileNodes);
      const float* const along = profile_x_.data() + (x_begin - first_x);
      for (int row = y_begin; row < y_end; ++row) {
        float* const line = nodes + (row - tile_y * kTileNodes) * kTileNodes;
        const float across = profile_y_[static_cast<std::size_t>(row - first_y)];
        for (int column = 0; column < x_end - x_begin; column += 4) {
          storeQuad(line + column, loadQuad(line + column) + loadQuad(along + column) * across);
        }
      }
      x_begin = x_end;
    }
    y_begin = y_end;
  }
}

double Sheet::fluenceAt(const Eigen::Vector2d& p_S_mm) const {
  const double x = p_S_mm.x() / kCellMm;
  const double y = p_S_mm.y() / kCellMm;
  if (!(std::abs(x) < 2.0 * kFarMm / kCellMm && std::abs(y) < 2.0 * kFarMm / kCellMm)) return 0.0;
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  const Quad weights_x = splineWeights(static_cast<float>(x - column));
  const Quad weights_y = splineWeights(static_cast<float>(y - row));
  const int tile_x = floorDiv(column - 1, kTileNodes);
  const int tile_y = floorDiv(row - 1, kTileNodes);
  const int in_x = column - 1 - tile_x * kTileNodes;
  const int in_y = row - 1 - tile_y * kTileNodes;
  float value = 0.0F;
  if (in_x + 4 <= kTileNodes && in_y + 4 <= kTileNodes) {
    const Tile* const tile = findTile(tile_x, tile_y);
    if (tile == nullptr) return 0.0;
    value = splineValue(tile->j_mm2.data() + in_y * kTileNodes + in_x, kTileNodes, weights_x, weights_y);
  } else {
    std::array<float, 16> nodes;
    if (copyNodes(column - 1, row - 1, 4, 4, nodes) == 0.0F) return 0.0;
    value = splineValue(nodes.data(), 4, weights_x, weights_y);
  }
  return std::max(0.0, static_cast<double>(value));
}

double Sheet::depthAt(const Eigen::Vector2d& p_S_mm) const {
  return std::min(1.0, fluenceAt(p_S_mm) / board_.cut_fluence_j_mm2);
}

bool Sheet::untouched(const Eigen::Vector2d& min_S_mm, const Eigen::Vector2d& max_S_mm) const {
  const auto node = [](double mm) { return static_cast<int>(std::clamp(mm / kCellMm, -1e9, 1e9)); };
  // Widened by the reach of the interpolation.
  const int first_x = node(min_S_mm.x()) - 2;
  const int first_y = node(min_S_mm.y()) - 2;
  const int last_x = node(max_S_mm.x()) + 2;
  const int last_y = node(max_S_mm.y()) + 2;
  const auto limit = static_cast<float>(kUntouchedDepth * board_.cut_fluence_j_mm2);
  const auto touchedIn = [&](int tile_x, int tile_y, const Tile& tile) {
    const int x0 = std::max(first_x - tile_x * kTileNodes, 0);
    const int x1 = std::min(last_x - tile_x * kTileNodes, kTileNodes - 1);
    const int y0 = std::max(first_y - tile_y * kTileNodes, 0);
    const int y1 = std::min(last_y - tile_y * kTileNodes, kTileNodes - 1);
    for (int y = y0; y <= y1; ++y) {
      const float* const line = tile.j_mm2.data() + y * kTileNodes;
      for (int x = x0; x <= x1; ++x) {
        if (line[x] > limit) return true;
      }
    }
    return false;
  };
  const int tile_x0 = floorDiv(first_x, kTileNodes);
  const int tile_x1 = floorDiv(last_x, kTileNodes);
  const int tile_y0 = floorDiv(first_y, kTileNodes);
  const int tile_y1 = floorDiv(last_y, kTileNodes);
  const double boxes = (tile_x1 - tile_x0 + 1.0) * (tile_y1 - tile_y0 + 1.0);
  if (boxes > static_cast<double>(tiles_.size())) {
    // A large box: cheaper to look at every tile there is. The answer does not depend on the order.
    return std::none_of(tile_index_.begin(), tile_index_.end(), [&](const auto& entry) {
      const auto tile_x = static_cast<int>(static_cast<std::uint32_t>(entry.first >> 32U));
      const auto tile_y = static_cast<int>(static_cast<std::uint32_t>(entry.first));
      return tile_x >= tile_x0 && tile_x <= tile_x1 && tile_y >= tile_y0 && tile_y <= tile_y1 &&
             touchedIn(tile_x, tile_y, tiles_[entry.second]);
    });
  }
  for (int tile_y = tile_y0; tile_y <= tile_y1; ++tile_y) {
    for (int tile_x = tile_x0; tile_x <= tile_x1; ++tile_x) {
      const Tile* const tile = findTile(tile_x, tile_y);
      if (tile != nullptr && touchedIn(tile_x, tile_y, *tile)) return false;
    }
  }
  return true;
}

float Sheet::copyNodes(int column, int row, int columns, int rows, std::span<float> out) const {
  if (columns <= 0 || rows <= 0 ||
      out.size() < static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {
    throw std::invalid_argument("Sheet::copyNodes: no room for the nodes");
  }
  float largest = 0.0F;
  for (int y_begin = row; y_begin < row + rows;) {
    const int tile_y = floorDiv(y_begin, kTileNodes);
    const int y_end = std::min(row + rows, (tile_y + 1) * kTileNodes);
    for (int x_begin = column; x_begin < column + columns;) {
      const int tile_x = floorDiv(x_begin, kTileNodes);
      const int x_end = std::min(column + columns, (tile_x + 1) * kTileNodes);
      const Tile* const tile = findTile(tile_x, tile_y);
      for (int y = y_begin; y < y_end; ++y) {
        float* const to = out.data() + static_cast<std::ptrdiff_t>(y - row) * columns + (x_begin - column);
        if (tile == nullptr) {
          std::fill_n(to, x_end - x_begin, 0.0F);
          continue;
        }
        const float* const line =
            tile->j_mm2.data() + (y - tile_y * kTileNodes) * kTileNodes + (x_begin - tile_x * kTileNodes);
        for (int i = 0; i < x_end - x_begin; ++i) {
          to[i] = line[i];
          largest = line[i] > largest ? line[i] : largest;
        }
      }
      x_begin = x_end;
    }
    y_begin = y_end;
  }
  return largest;
}

double Sheet::energyJ() const {
  double sum_j_mm2 = 0.0;
  for (const Tile& tile : tiles_) {
    for (const float node : tile.j_mm2) sum_j_mm2 += static_cast<double>(node);
  }
  return sum_j_mm2 * kCellMm * kCellMm;
}

std::uint64_t Sheet::keyOf(int tile_x, int tile_y) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(tile_x)) << 32U |
         static_cast<std::uint32_t>(tile_y);
}

Sheet::Tile& Sheet::tileFor(int tile_x, int tile_y) {
  const std::uint64_t key = keyOf(tile_x, tile_y);
  Recent& recent = recent_[static_cast<std::size_t>((tile_x & 3) | (tile_y & 3) << 2)];
  if (!recent.used || recent.key != key) {
    const auto [entry, fresh] = tile_index_.try_emplace(key, tiles_.size());
    if (fresh) tiles_.emplace_back();
    recent = {key, entry->second, true};
  }
  return tiles_[recent.tile];
}

const Sheet::Tile* Sheet::findTile(int tile_x, int tile_y) const {
  const auto entry = tile_index_.find(keyOf(tile_x, tile_y));
  return entry == tile_index_.end() ? nullptr : &tiles_[entry->second];
}

}  // namespace kerfbench::twin
