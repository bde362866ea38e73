// SPDX-License-Identifier: Apache-2.0
#include "twin/sheet/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "twin/sheet/cubic_spline.h"

namespace kerfbench::twin {
namespace {

/// Length of a part as a share of the smallest radius. A part is burnt as one bell that carries the part's
/// own length as variance, which leaves no ripple along a line and 2e-4 of the peak at its ends.
constexpr double kPartRadii = 0.5;
constexpr double kMinRadiusMm = 0.03;  // Smallest radius that counts for the length of a part.
constexpr double kFarMm = 1e6;

int floorDiv(int value, int divisor) {
  const int quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

Footprint between(const Footprint& from, const Footprint& to, double u) {
  return {from.p_SQ_mm + u * (to.p_SQ_mm - from.p_SQ_mm),
          from.radius_x_mm + u * (to.radius_x_mm - from.radius_x_mm),
          from.radius_y_mm + u * (to.radius_y_mm - from.radius_y_mm),
          from.correlation + u * (to.correlation - from.correlation)};
}

/// Square of the smaller radius of the ellipse, or less.
double smallSquare_mm2(const Footprint& footprint) {
  const double smaller_mm = std::min(footprint.radius_x_mm, footprint.radius_y_mm);
  return smaller_mm * smaller_mm * (1.0 - std::abs(footprint.correlation));
}

/// Number of parts into which a move is divided.
int partsOf(const Footprint& from, const Footprint& to) {
  const double small_mm2 =
      std::max(std::min(smallSquare_mm2(from), smallSquare_mm2(to)), kMinRadiusMm * kMinRadiusMm);
  const double parts2 = (to.p_SQ_mm - from.p_SQ_mm).squaredNorm() / (kPartRadii * kPartRadii * small_mm2);
  return parts2 <= 1.0 ? 1 : static_cast<int>(std::ceil(std::sqrt(parts2)));
}

/// Footprint smeared along `move_mm`; a line of length L has the variance L²/12 along itself.
GaussianFootprint smeared(const Footprint& footprint, const Eigen::Vector2d& move_mm) {
  constexpr double kNodesPerMm = 1.0 / Sheet::kCellMm;
  const Eigen::Vector2d centre = footprint.p_SQ_mm * kNodesPerMm;
  const Eigen::Vector2d move = move_mm * kNodesPerMm;
  const double sigma_x = 0.5 * kNodesPerMm * footprint.radius_x_mm;
  const double sigma_y = 0.5 * kNodesPerMm * footprint.radius_y_mm;
  return {centre, sigma_x * sigma_x + move.x() * move.x() / 12.0,
          sigma_y * sigma_y + move.y() * move.y() / 12.0,
          footprint.correlation * sigma_x * sigma_y + move.x() * move.y() / 12.0};
}

bool inRange(const Footprint& footprint) {
  const auto radiusFits = [](double radius_mm) { return radius_mm > 0.0 && radius_mm <= 100.0; };
  return std::abs(footprint.p_SQ_mm.x()) <= kFarMm && std::abs(footprint.p_SQ_mm.y()) <= kFarMm &&
         radiusFits(footprint.radius_x_mm) && radiusFits(footprint.radius_y_mm) &&
         std::abs(footprint.correlation) < 1.0;
}

/// Largest x that a footprint burns.
double reach_x_mm(const Footprint& footprint) {
  return footprint.p_SQ_mm.x() + 0.5 * SampledBell::kReach * footprint.radius_x_mm;
}

bool scorches(const BoardDescription& board) {
  return board.scorch.fluence_j_mm2 > 0.0 && board.scorch.darkening > 0.0;
}

const BoardDescription& checked(const BoardDescription& board) {
  const std::string faults = faultsOf(board);
  if (!faults.empty()) throw std::invalid_argument(faults);
  return board;
}

}  // namespace

Sheet::Sheet(const BoardDescription& board)
    : board_(checked(board)),
      depth_(board),
      untouched_burn_j_mm2_(depth_.fluenceFor_j_mm2(kUntouchedDepth)),
      untouched_scorch_j_mm2_(scorches(board)
                                  ? board.scorch.fluence_j_mm2 * kUntouchedDepth / board.scorch.darkening
                                  : std::numeric_limits<double>::infinity()) {}

void Sheet::burn(const Footprint& from, const Footprint& to, double energy_j) {
  if (energy_j == 0.0) return;
  if (!(energy_j > 0.0 && std::isfinite(energy_j)) || !inRange(from) || !inRange(to)) {
    throw std::invalid_argument("Sheet::burn: energy, place or radius out of range");
  }
  if (reach_x_mm(from) > parted_x_mm_ || reach_x_mm(to) > parted_x_mm_) {
    beam_on_parted_ = true;
    return;
  }
  const Eigen::Vector2d move_mm = to.p_SQ_mm - from.p_SQ_mm;
  const int parts = partsOf(from, to);
  for (int part = 0; part < parts; ++part) {
    const Footprint middle = between(from, to, (part + 0.5) / parts);
    lay(splineCoefficientsOf(smeared(middle, move_mm / parts)), energy_j / parts);
  }
}

void Sheet::lay(const GaussianFootprint& bell, double energy_j) {
  constexpr double kMost = SampledBell::kMaxCorrelation * SampledBell::kMaxCorrelation;
  if (bell.covariance * bell.covariance <= kMost * bell.variance_x * bell.variance_y) {
    return add(bell, energy_j);
  }
  // A slim ellipse is burnt as a row of plumper ones along its major axis, whose energies form a bell. With
  // the axes in the ratio sqrt 3 the correlation is kMaxCorrelation at most.
  const double half = 0.5 * (bell.variance_x - bell.variance_y);
  const double spread = std::sqrt(half * half + bell.covariance * bell.covariance);
  const double mean = 0.5 * (bell.variance_x + bell.variance_y);
  const double minor = mean - spread;
  const double kept = 3.0 * minor;
  const double taken = mean + spread - kept;
  const double cos2 = half / spread;  // Cosine of twice the angle of the major axis.
  const double sin2 = bell.covariance / spread;
  const Eigen::Vector2d axis(std::sqrt(0.5 * (1.0 + cos2)),
                             std::copysign(std::sqrt(0.5 * (1.0 - cos2)), sin2));
  GaussianFootprint piece{bell.centre, bell.variance_x - 0.5 * taken * (1.0 + cos2),
                          bell.variance_y - 0.5 * taken * (1.0 - cos2), bell.covariance - 0.5 * taken * sin2};
  const double spacing = std::sqrt(std::min(kept, taken));
  const int side = static_cast<int>(std::ceil(SampledBell::kReach * std::sqrt(taken) / spacing));
  const auto weight = [&](int i) { return std::exp(-0.5 * (i * spacing) * (i * spacing) / taken); };
  double sum = 0.0;
  for (int i = -side; i <= side; ++i) sum += weight(i);
  for (int i = -side; i <= side; ++i) {
    piece.centre = bell.centre + i * spacing * axis;
    add(piece, energy_j * weight(i) / sum);
  }
}

void Sheet::add(const GaussianFootprint& bell, double energy_j) {
  sampled_.sample(bell, energy_j / (kCellMm * kCellMm));
  const int first_x = sampled_.firstColumn();
  const int last_x = first_x + 4 * static_cast<int>(sampled_.columns().size());
  const int first_y = sampled_.firstRow();
  const int last_y = first_y + static_cast<int>(sampled_.rows().size());
  for (int y_begin = first_y; y_begin < last_y;) {
    const int tile_y = floorDiv(y_begin, kTileNodes);
    const int y_end = std::min(last_y, (tile_y + 1) * kTileNodes);
    spans_.clear();
    for (int x_begin = first_x; x_begin < last_x;) {
      const int tile_x = floorDiv(x_begin, kTileNodes);
      const int x_end = std::min(last_x, (tile_x + 1) * kTileNodes);
      spans_.push_back(
          {tileFor(tile_x, tile_y).j_mm2.data() + (x_begin - tile_x * kTileNodes), (x_end - x_begin) / 4});
      x_begin = x_end;
    }
    for (int y = y_begin; y < y_end;) {
      const SampledBell::Row* const rows = sampled_.rows().data() + (y - first_y);
      const std::ptrdiff_t line = static_cast<std::ptrdiff_t>(y - tile_y * kTileNodes) * kTileNodes;
      const int together = std::min(y_end - y, 2);
      together == 2 ? addRows<2>(rows, line) : addRows<1>(rows, line);
      y += together;
    }
    y_begin = y_end;
  }
}

template <int kRows>
void Sheet::addRows(const SampledBell::Row* rows, std::ptrdiff_t line) {
  std::array<Quad, kRows> factor, step;
  for (std::size_t r = 0; r < kRows; ++r) {
    factor[r] = rows[r].start;
    step[r] = Quad{} + rows[r].step;
  }
  const Quad* column = sampled_.columns().data();
  for (const Span& span : spans_) {
    float* const nodes = span.nodes + line;
    const int quads = span.quads;
    for (int quad = 0; quad < quads; ++quad) {
      for (std::size_t r = 0; r < kRows; ++r) {
        float* const node = nodes + r * kTileNodes + 4 * static_cast<std::size_t>(quad);
        storeQuad(node, loadQuad(node) + column[quad] * factor[r]);
        factor[r] *= step[r];
      }
    }
    column += quads;
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

double Sheet::depthAt(const Eigen::Vector2d& p_S_mm) const { return depth_.depthAt(fluenceAt(p_S_mm)); }

double Sheet::scorchAt(const Eigen::Vector2d& p_S_mm) const {
  if (board_.scorch.fluence_j_mm2 == 0.0) return 0.0;
  const Eigen::Vector2d shift_mm(board_.scorch.shift_mm[0], board_.scorch.shift_mm[1]);
  return std::min(1.0, fluenceAt(p_S_mm - shift_mm) / board_.scorch.fluence_j_mm2);
}

bool Sheet::untouched(const Eigen::Vector2d& min_S_mm, const Eigen::Vector2d& max_S_mm) const {
  if (!below(min_S_mm, max_S_mm, untouched_burn_j_mm2_)) return false;
  if (!scorches(board_)) return true;
  const Eigen::Vector2d shift_mm(board_.scorch.shift_mm[0], board_.scorch.shift_mm[1]);
  return below(min_S_mm - shift_mm, max_S_mm - shift_mm, untouched_scorch_j_mm2_);
}

bool Sheet::below(const Eigen::Vector2d& min_S_mm, const Eigen::Vector2d& max_S_mm,
                  double limit_j_mm2) const {
  const auto node = [](double mm) { return static_cast<int>(std::clamp(mm / kCellMm, -1e9, 1e9)); };
  // The box is widened by the reach of the interpolation.
  const int first_x = node(min_S_mm.x()) - 2;
  const int first_y = node(min_S_mm.y()) - 2;
  const int last_x = node(max_S_mm.x()) + 2;
  const int last_y = node(max_S_mm.y()) + 2;
  const auto limit = static_cast<float>(limit_j_mm2);
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
    // A large box has more places than there are tiles: every existing tile is tested.
    return std::ranges::none_of(tiles_, [&](const Tile& tile) {
      return tile.x >= tile_x0 && tile.x <= tile_x1 && tile.y >= tile_y0 && tile.y <= tile_y1 &&
             touchedIn(tile.x, tile.y, tile);
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

bool Sheet::hasNodes(int column, int row, int columns, int rows) const {
  for (int y = floorDiv(row, kTileNodes); y <= floorDiv(row + rows - 1, kTileNodes); ++y) {
    for (int x = floorDiv(column, kTileNodes); x <= floorDiv(column + columns - 1, kTileNodes); ++x) {
      if (findTile(x, y) != nullptr) return true;
    }
  }
  return false;
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
    const auto [entry, fresh] = tile_index_.try_emplace(key, 0);
    if (fresh) {
      entry->second = freshTile();
      tiles_[entry->second].x = tile_x;
      tiles_[entry->second].y = tile_y;
      occupied_.set(slotOf(tile_x, tile_y));
    }
    recent = {key, entry->second, true};
  }
  return tiles_[recent.tile];
}

std::size_t Sheet::freshTile() {
  if (vacant_.empty()) {
    tiles_.emplace_back();
    return tiles_.size() - 1;
  }
  const std::size_t tile = vacant_.back();
  vacant_.pop_back();
  return tile;
}

Sheet Sheet::part(double x_S_mm) {
  constexpr double kTile_mm = kTileNodes * kCellMm;
  Sheet piece(board_);
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    const auto known = tile_index_.find(keyOf(tile.x, tile.y));
    const bool is_vacant = known == tile_index_.end() || known->second != i;
    if (is_vacant || (tile.x + 1) * kTile_mm < x_S_mm - kBothKeep_mm) continue;
    piece.tile_index_.emplace(known->first, piece.tiles_.size());
    piece.tiles_.push_back(tile);
    piece.occupied_.set(slotOf(tile.x, tile.y));
    if (tile.x * kTile_mm <= x_S_mm + kBothKeep_mm) continue;
    tile_index_.erase(known);
    tile = {};
    vacant_.push_back(i);
  }
  occupied_.reset();
  for (const auto& [key, tile] : tile_index_) occupied_.set(slotOf(tiles_[tile].x, tiles_[tile].y));
  recent_ = {};
  parted_x_mm_ = std::min(parted_x_mm_, x_S_mm);
  return piece;
}

const Sheet::Tile* Sheet::findTile(int tile_x, int tile_y) const {
  if (!occupied_.test(slotOf(tile_x, tile_y))) return nullptr;
  const auto entry = tile_index_.find(keyOf(tile_x, tile_y));
  return entry == tile_index_.end() ? nullptr : &tiles_[entry->second];
}

}  // namespace kerfbench::twin
