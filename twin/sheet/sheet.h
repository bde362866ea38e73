// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "twin/sheet/board_description.h"
#include "twin/sheet/depth_curve.h"
#include "twin/sheet/gaussian_footprint.h"

namespace kerfbench::twin {

/// The beam on the sheet during a short time: an elliptical Gaussian.
struct Footprint {
  Eigen::Vector2d p_SQ_mm{Eigen::Vector2d::Zero()};  ///< Centre on the web, in S of unit 0.
  double radius_x_mm{0.105};  ///< Radius (1/e²) along Sx, in (0, 100]; burnt no smaller than 0.031 mm.
  double radius_y_mm{0.105};
  /// Correlation of x and y: an ellipse whose axes are not those of S (oblique incidence at a corner of the
  /// field); |.| < 1.
  double correlation{};
};

/// Absorbed energy on the web as a sparse map: a uniform cubic B-spline whose coefficient (i, j) sits at p_S
/// = (i, j) * kCellMm. A spot is stored narrower by the spline's own variance (kCellMm²/3), so that the
/// smooth surface is the spot: within 2e-4 of the peak for a radius of 0.1 mm, without any filter. The peak
/// of a line cut at power P and speed F is sqrt(2/pi) P / (F w) for a round spot of radius w: with d = 2 w
/// that is 2 sqrt(2/pi) P_ua of S3.
///
/// Reading is const and safe from any number of threads while nobody burns. Memory: 4 KiB per burnt square of
/// 0.64 mm, about 10 MB per metre of cut. A web of any length fits if what has left the machine is parted
/// off.
class Sheet {
 public:
  static constexpr double kCellMm = 0.02;
  /// Largest depth that counts as untouched: it changes a picture by less than a hundredth of a grey level.
  static constexpr double kUntouchedDepth = 1e-4;

  /// Makes an unburnt sheet. @throws std::invalid_argument that names every value out of range.
  explicit Sheet(const BoardDescription& board);

  /// Burns a straight move of the beam from `from` to `to` with `energy_j`, delivered evenly. No energy, no
  /// burn. All of the energy stays on the sheet, to 1e-5.
  ///
  /// One bell is stored for each half radius of the path, with the variance of that length, so a move of up
  /// to half a radius costs as much as a spot at rest. The caller may pass a chord instead of many short
  /// moves: on a straight line at constant power nothing changes but the ends (2e-4 of the peak); a bend of
  /// radius R shifts the cut inwards by L²/(12 R) for chords of L, 0.02 µm for 10 µm at R = 0.5 mm; power
  /// that rises within the chord is averaged over it. @throws std::invalid_argument for values that are not
  /// finite, out of range (|p| > 1e6 mm).
  void burn(const Footprint& from, const Footprint& to, double energy_j);

  /// Absorbed energy at a point, J/mm²; smooth (twice differentiable).
  [[nodiscard]] double fluenceAt(const Eigen::Vector2d& p_S_mm) const;
  /// Burnt depth over thickness, 0 untouched … 1 cut through.
  [[nodiscard]] double depthAt(const Eigen::Vector2d& p_S_mm) const;
  /// Degree of discolouration, 0 none … 1 full: by the fluence that the air has blown here, from p_S_mm -
  /// scorch.shift_mm. Always 0 for board without scorch.
  [[nodiscard]] double scorchAt(const Eigen::Vector2d& p_S_mm) const;
  [[nodiscard]] const BoardDescription& board() const { return board_; }
  [[nodiscard]] const DepthCurve& depthCurve() const { return depth_; }
  /// True if nothing was burnt within the box (deeper than kUntouchedDepth), nor scorched so that a picture
  /// shows more than that.
  [[nodiscard]] bool untouched(const Eigen::Vector2d& min_S_mm, const Eigen::Vector2d& max_S_mm) const;
  /// Fluence up to which board counts as not burnt, and board displaced by scorch.shift_mm as not scorched.
  [[nodiscard]] double untouchedFluence_j_mm2() const { return untouched_burn_j_mm2_; }
  [[nodiscard]] double unscorchedFluence_j_mm2() const { return untouched_scorch_j_mm2_; }

  /// How far on either side of a parting both pieces keep what was burnt: as far as the air carries scorch,
  /// and two cells.
  static constexpr double kBothKeep_mm = 1.04;
  /// Parts the web across Sx: returns what lies at x >= `x_S_mm` and keeps the rest. Nobody can burn what was
  /// returned, see beamOnPartedWeb().
  Sheet part(double x_S_mm);
  /// True if the beam has reached web that had been parted off before; what it did there is on neither piece.
  [[nodiscard]] bool beamOnPartedWeb() const { return beam_on_parted_; }

  /// False where no coefficient [column, column + columns) x [row, row + rows) can be other than zero,
  /// because no beam came near.
  [[nodiscard]] bool hasNodes(int column, int row, int columns, int rows) const;
  /// Copies the spline's coefficients [column, column + columns) x [row, row + rows), row-major, into `out`
  /// (columns * rows values, J/mm²) and returns the largest: no fluence between them is higher.
  float copyNodes(int column, int row, int columns, int rows, std::span<float> out) const;
  /// All energy on the sheet.
  [[nodiscard]] double energyJ() const;
  /// Memory of the map.
  [[nodiscard]] std::size_t bytes() const { return tiles_.size() * sizeof(Tile); }

 private:
  static constexpr int kTileNodes = 32;
  struct Tile {
    alignas(16) std::array<float, static_cast<std::size_t>(kTileNodes* kTileNodes)> j_mm2{};
    int x{}, y{};  ///< Place in tiles.
  };
  struct Recent {
    std::uint64_t key{};
    std::size_t tile{};
    bool used{};
  };

  /// Nodes of one row that lie in one tile.
  struct Span {
    float* nodes{};
    int quads{};
  };

  static std::uint64_t keyOf(int tile_x, int tile_y);
  /// Place of a tile in `occupied_`, which many far from each other share.
  static std::size_t slotOf(int tile_x, int tile_y) {
    return static_cast<std::size_t>((tile_x & 63) | (tile_y & 63) << 6);
  }
  Tile& tileFor(int tile_x, int tile_y);
  [[nodiscard]] const Tile* findTile(int tile_x, int tile_y) const;
  std::size_t freshTile();
  void lay(const GaussianFootprint& bell, double energy_j);
  void add(const GaussianFootprint& bell, double energy_j);
  /// Adds the first kRows of `rows` to the spans, `line` nodes below their first row.
  template <int kRows>
  void addRows(const SampledBell::Row* rows, std::ptrdiff_t line);
  /// True if no coefficient that matters within the box is above `limit_j_mm2`.
  [[nodiscard]] bool below(const Eigen::Vector2d& min_S_mm, const Eigen::Vector2d& max_S_mm,
                           double limit_j_mm2) const;

  BoardDescription board_;
  DepthCurve depth_;
  double untouched_burn_j_mm2_;
  double untouched_scorch_j_mm2_;
  std::deque<Tile> tiles_;  ///< Tiles in order of first touch: sums over them never depend on the hash.
  std::vector<std::size_t> vacant_;  ///< Tiles that were parted off: all zero, and used again first.
  std::unordered_map<std::uint64_t, std::size_t> tile_index_;
  double parted_x_mm_{std::numeric_limits<double>::infinity()};  ///< Web from here on was parted off.
  bool beam_on_parted_{false};
  std::bitset<64 * 64> occupied_;    ///< False where no tile is: most of what is asked for, without the hash.
  std::array<Recent, 16> recent_{};  ///< Recently burnt tiles: a cut stays within a few for long.
  SampledBell sampled_;              ///< Scratch of add().
  std::vector<Span> spans_;
};

}  // namespace kerfbench::twin
