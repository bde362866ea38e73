// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::twin {

/// The board and how a CO2 beam eats it.
struct BoardDescription {
  double thickness_mm{0.4};
  /// Energy per area (J/mm²), summed over all passes, at which the board is just cut through. Depth grows
  /// linearly with it up to there (S3: D = f(P_ua), linear before saturation).
  double cut_fluence_j_mm2{0.5};
  double transmission{0.12};        ///< Of the back light through uncut board, 0…1.
  double print_transmission{0.02};  ///< Through board under a registration mark.
};

/// The beam on the sheet during a short time: an elliptical Gaussian.
struct Footprint {
  Eigen::Vector2d p_SQ_mm{Eigen::Vector2d::Zero()};  ///< Centre on the web, in S of unit 0.
  double radius_x_mm{0.105};  ///< 1/e² radius along Sx, in (0, 100]; drawn no smaller than 0.031 mm.
  double radius_y_mm{0.105};
};

/// The web as a map of absorbed energy, sparse: a uniform cubic B-spline whose coefficient (i, j) sits at
/// p_S = (i, j) * kCellMm. A spot is laid down narrower by the spline's own variance (kCellMm²/3), so that
/// the smooth surface is the spot: within 2e-4 of the peak for a radius of 0.1 mm, without any filter. The
/// peak of a line cut at power P and speed v is P/v * sqrt(2/pi) / w for a round spot of radius w.
///
/// Reading is const and safe from any number of threads while nobody burns. Memory: 4 KiB per burnt square of
/// 0.64 mm, about 10 MB per metre of cut.
class Sheet {
 public:
  static constexpr double kCellMm = 0.02;
  /// Less depth than this counts as untouched: it changes a picture by less than a hundredth of a grey level.
  static constexpr double kUntouchedDepth = 1e-4;

  /// @throws std::invalid_argument that names every value out of range.
  explicit Sheet(const BoardDescription& board);

  /// The beam moved straight from `from` to `to` while it delivered `energy_j`, evenly. No energy, no burn.
  /// All of the energy stays on the sheet: the tails beyond 2.4 radii (1e-5) are folded in.
  /// @throws std::invalid_argument for values that are not finite, out of range (|p| > 1e6 mm).
  void burn(const Footprint& from, const Footprint& to, double energy_j);

  /// Absorbed energy at a point, J/mm²; smooth (twice differentiable).
  [[nodiscard]] double fluenceAt(const Eigen::Vector2d& p_S_mm) const;
  /// Burnt depth over thickness, 0 untouched … 1 cut through.
  [[nodiscard]] double depthAt(const Eigen::Vector2d& p_S_mm) const;
  [[nodiscard]] const BoardDescription& board() const { return board_; }
  /// True if nothing was burnt within the box (deeper than kUntouchedDepth).
  [[nodiscard]] bool untouched(const Eigen::Vector2d& min_S_mm, const Eigen::Vector2d& max_S_mm) const;

  /// Copies the spline's coefficients [column, column + columns) x [row, row + rows), row-major, into `out`
  /// (columns * rows values, J/mm²) and returns the largest: no fluence between them is higher.
  float copyNodes(int column, int row, int columns, int rows, std::span<float> out) const;
  /// All energy on the sheet.
  [[nodiscard]] double energyJ() const;
  /// What the map takes in memory.
  [[nodiscard]] std::size_t bytes() const { return tiles_.size() * sizeof(Tile); }

 private:
  static constexpr int kTileNodes = 32;
  struct Tile {
    alignas(16) std::array<float, static_cast<std::size_t>(kTileNodes* kTileNodes)> j_mm2{};
  };
  struct Recent {
    std::uint64_t key{};
    std::size_t tile{};
    bool used{};
  };

  static std::uint64_t keyOf(int tile_x, int tile_y);
  Tile& tileFor(int tile_x, int tile_y);
  [[nodiscard]] const Tile* findTile(int tile_x, int tile_y) const;
  void deposit(const Footprint& footprint, double energy_j);

  BoardDescription board_;
  std::deque<Tile> tiles_;  ///< In order of first touch: sums over it never depend on the hash.
  std::unordered_map<std::uint64_t, std::size_t> tile_index_;
  std::array<Recent, 16> recent_{};  ///< Tiles lately burnt: a cut stays within a few for long.
  std::vector<float> profile_x_;     ///< Scratch of deposit().
  std::vector<float> profile_y_;
};

}  // namespace kerfbench::twin
