// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "twin/camera/board_field.h"
#include "twin/camera/camera.h"
#include "twin/camera/spline_row.h"
#include "twin/camera/spline_weights.h"
#include "twin/sheet/sheet.h"

/// Transmission of the back light through a burnt sheet; of use to KerfCamera alone.
namespace kerfbench::twin {

/// A function of a share, 0…1; larger shares count as 1.
class ShareTable {
 public:
  template <class Function>
  explicit ShareTable(const Function& function) {
    for (std::size_t i = 0; i < table_.size(); ++i)
      table_[i] = static_cast<float>(function(static_cast<double>(i) / static_cast<double>(kSteps)));
  }
  [[nodiscard]] float at(float share) const {
    const float place = (share < 1.0F ? share : 1.0F) * static_cast<float>(kSteps);
    return table_[static_cast<std::size_t>(static_cast<int>(place + 0.5F))];
  }

 private:
  static constexpr std::size_t kSteps = 4096;
  std::array<float, kSteps + 1> table_{};
};

/// DepthCurve::unboundedDepthAt() of board that absorbed a share of the fluence that cuts.
class WallTable {
 public:
  explicit WallTable(const Sheet& sheet)
      : below_([&](double share) { return depthAt(sheet, share); }),
        beyond_(static_cast<float>(depthAt(sheet, 2.0) - 1.0)) {}
  [[nodiscard]] float at(float share) const {
    return share < 1.0F ? below_.at(share) : 1.0F + beyond_ * (share - 1.0F);
  }

 private:
  static double depthAt(const Sheet& sheet, double share) {
    return sheet.depthCurve().unboundedDepthAt(share * sheet.board().cut_fluence_j_mm2);
  }
  ShareTable below_;
  float beyond_;
};
/// Grey level of the back light where a share of the board's thickness is left, of board that transmits
/// `transmission`.
inline ShareTable grayOfLeft(const Sheet& sheet, double transmission, double open_gray) {
  return ShareTable(
      [&](double left) { return open_gray * lightThrough(sheet.board().light_law, transmission, left); });
}
/// Grey level where the board absorbed a share of the fluence that cuts, seen square to the sheet.
inline ShareTable grayOfFluence(const Sheet& sheet, double transmission, double open_gray) {
  return ShareTable([&](double share) {
    const double depth = sheet.depthCurve().depthAt(share * sheet.board().cut_fluence_j_mm2);
    return open_gray * lightThrough(sheet.board().light_law, transmission, 1.0 - depth);
  });
}

/// Lines of sight that cross a thick board aslant, in the spline's own unit: between its faces they go on by
/// at_origin + per_node p, p being where they enter.
struct ObliqueSight {
  WallTable depth;
  ShareTable board, print;  ///< grayOfLeft()
  Eigen::Vector2d at_origin{Eigen::Vector2d::Zero()};
  double per_node{};
  int slices{};  ///< Slices of the block; 0: so little aslant that it counts as square.

  /// Way through the whole board of the line of sight that enters at a place.
  [[nodiscard]] Eigen::Vector2d through(const Eigen::Vector2d& p_nodes) const {
    return at_origin + per_node * p_nodes;
  }
};

/// A printed mark (round) or other print (a rectangle) in the spline's own unit.
struct PrintShape {
  bool round{};
  Eigen::Vector2d centre_nodes;
  Eigen::Vector2d half_nodes;  ///< Half its size along its own axes.
  double cos{1.0}, sin{0.0};   ///< Cosine and sine of its axes' angle.
  float ink{1.0F};

  /// Distance outside of the border; < 0 within.
  [[nodiscard]] double outside(double x, double y) const {
    const double dx = x - centre_nodes.x();
    const double dy = y - centre_nodes.y();
    if (round) return std::sqrt(dx * dx + dy * dy) - half_nodes.x();
    return std::max(std::abs(cos * dx + sin * dy) - half_nodes.x(),
                    std::abs(cos * dy - sin * dx) - half_nodes.y());
  }
};

/// Coefficients of the sheet around a block.
struct Window {
  int column{}, row{}, columns{}, rows{};
  std::vector<float> nodes;
  std::vector<char> whole;  ///< For each cell, behind its node: see findWhole().

  [[nodiscard]] std::size_t cellOf(float x, float y) const {
    return static_cast<std::size_t>(static_cast<int>(y)) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(static_cast<int>(x));
  }
};

/// Finds the cells whose board is whole: no node that the spline takes for a place in them, or as far from
/// them as `reach_nodes`, has more than `limit`. Most of a block with a kerf is such board.
inline void findWhole(float limit, int reach_nodes, Window& window) {
  const auto columns = static_cast<std::size_t>(window.columns);
  const auto rows = static_cast<std::size_t>(window.rows);
  const auto before = static_cast<std::size_t>(1 + reach_nodes);
  const auto behind = static_cast<std::size_t>(2 + reach_nodes);
  std::vector<char> row_whole(window.nodes.size(), 1);
  window.whole.assign(window.nodes.size(), 1);
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      if (!(window.nodes[r * columns + c] > limit)) continue;
      const std::size_t first = c > behind ? c - behind : 0;
      std::fill_n(row_whole.begin() + static_cast<std::ptrdiff_t>(r * columns + first),
                  std::min(c + before + 1, columns) - first, char{0});
    }
  }
  for (std::size_t r = 0; r < rows; ++r) {
    const char* const from = row_whole.data() + r * columns;
    for (std::size_t to = r > behind ? r - behind : 0; to < std::min(r + before + 1, rows); ++to) {
      char* const line = window.whole.data() + to * columns;
      for (std::size_t c = 0; c < columns; ++c) line[c] = static_cast<char>(line[c] & from[c]);
    }
  }
}

/// The 4 x 4 nodes of a window around a place, given by the window's first node, and the place between them.
struct Around {
  const float* nodes;
  std::size_t stride;
  float x, y;

  Around(const float* window, std::size_t columns, float place_x, float place_y) : stride(columns) {
    // Conversion through int: the processor has no instruction from float to size_t.
    const int column = static_cast<int>(place_x);
    const int row = static_cast<int>(place_y);
    nodes =
        window + (static_cast<std::ptrdiff_t>(row - 1) * static_cast<std::ptrdiff_t>(columns) + (column - 1));
    x = place_x - static_cast<float>(column);
    y = place_y - static_cast<float>(row);
  }
};

/// Discolouration of the board, in the spline's own unit.
struct Scorch {
  bool fitted{};
  Eigen::Vector2d shift_nodes{Eigen::Vector2d::Zero()};
  float per_fluence{};
  float darkening{};
};

/// Displacement of the places where depth is read, in the spline's own unit.
struct Roughness {
  BoardField field_x, field_y;
  float rms_nodes{};
  double fields_per_node{};        ///< Spacing of the spline over that of the fields.
  FieldWindow window_x, window_y;  ///< Windows of the block along x and y.

  Roughness(std::uint64_t board_seed, const EdgeRoughness& roughness)
      : field_x(board_seed, kStreamX, roughness.length_mm),
        field_y(board_seed, kStreamY, roughness.length_mm),
        rms_nodes(static_cast<float>(roughness.rms_mm / Sheet::kCellMm)),
        fields_per_node(Sheet::kCellMm / field_x.nodePitch_mm()) {}
  [[nodiscard]] int reachNodes() const {
    return static_cast<int>(std::ceil(BoardField::kLimit * static_cast<double>(rms_nodes)));
  }
  void fill(const Eigen::AlignedBox2d& box_nodes) {
    const Eigen::AlignedBox2d box(box_nodes.min() * fields_per_node, box_nodes.max() * fields_per_node);
    window_x.fill(field_x, box);
    window_y.fill(field_y, box);
  }

 private:
  static constexpr std::uint64_t kStreamX = 3;
  static constexpr std::uint64_t kStreamY = 4;
};

/// Data that the blocks of one tile share, and scratch.
struct TileJob {
  const Sheet& sheet;
  ShareTable board;  ///< grayOfFluence()
  ShareTable print;
  float open_gray;
  float share_per_fluence;
  double piece_min_nodes;
  double piece_max_nodes;
  std::vector<PrintShape> print_shapes;
  Scorch scorch;
  Window burn;
  Window charred;  ///< Coefficients that scorched the block: the burn's window less the shift.
  std::vector<PrintShape> near;
  std::optional<Roughness> rough;
  std::optional<ObliqueSight> oblique;
};

/// Places of a picture's samples in one row of a block; they count from the first node of the burn's window.
struct SampleRow {
  std::size_t count{};
  RowValues x, y;
};

/// Grey levels of the places of one block, row by row.
template <bool kScorched, bool kRough, bool kOblique>
class BlockPainter {
 public:
  BlockPainter(const TileJob& job, const SplineWeightTable& weights, bool burnt, double sample_nodes)
      : job_(job),
        weights_(weights),
        burn_{burnt ? job.burn.nodes.data() : nullptr, job.burn.columns},
        share_per_fluence_(job.share_per_fluence),
        sample_nodes_(sample_nodes) {
    const double x = job.burn.column - job.scorch.shift_nodes.x() - job.charred.column;
    const double y = job.burn.row - job.scorch.shift_nodes.y() - job.charred.row;
    to_charred_x_ = static_cast<float>(x);
    to_charred_y_ = static_cast<float>(y);
    if constexpr (kOblique) {
      const ObliqueSight& sight = *job_.oblique;
      const double per_slice = 1.0 / sight.slices;
      slice_at_origin_ = (per_slice * sight.through(origin())).template cast<float>();
      slice_per_node_ = static_cast<float>(per_slice * sight.per_node);
      per_slice_ = static_cast<float>(per_slice);
    }
    if constexpr (kRough) {
      const Eigen::Vector2d to_field = origin() * job.rough->fields_per_node - job.rough->window_x.origin();
      to_field_x_ = static_cast<float>(to_field.x());
      to_field_y_ = static_cast<float>(to_field.y());
    }
  }
  [[nodiscard]] Eigen::Vector2d origin() const { return {job_.burn.column, job_.burn.row}; }

  /// Grey levels by print and scorch at the places of a row, and by depth at places near them.
  void paint(const SampleRow& row, RowValues& gray) {
    findBurnt(row);
    if constexpr (kScorched) open_.fill(0.0F);
    if constexpr (kOblique) {
      followSight();
    } else {
      readShares();
    }
    const ShareTable& board = kOblique ? job_.oblique->board : job_.board;
    std::fill_n(gray.begin(), row.count, board.at(kWhole));
    for (std::size_t k = 0; k < burnt_.count; ++k) gray[burnt_.place[k]] = board.at(light_[k]);
    if (!job_.near.empty()) print(row, gray);
    if constexpr (kScorched) scorch(row, gray);
  }

 private:
  /// Places of a row where board may be missing, and where their depth is read.
  struct Burnt {
    std::size_t count{};
    std::array<std::uint8_t, kMostInRow> place;
    RowValues x, y;
  };

  void findBurnt(const SampleRow& row) {
    burnt_.count = 0;
    if (burn_.first == nullptr) return;
    for (std::size_t i = 0; i < row.count; ++i) {
      float x = row.x[i];
      float y = row.y[i];
      if constexpr (kRough) {
        const Eigen::Vector2f off = displacement(x, y);
        x += off.x();
        y += off.y();
      }
      const std::size_t k = burnt_.count;
      burnt_.place[k] = static_cast<std::uint8_t>(i);
      burnt_.x[k] = x;
      burnt_.y[k] = y;
      burnt_.count += job_.burn.whole[job_.burn.cellOf(x, y)] != 0 ? 0U : 1U;
    }
  }

  /// Lays the print over a row.
  void print(const SampleRow& row, RowValues& gray) const {
    const ShareTable& print = kOblique ? job_.oblique->print : job_.print;
    RowValues printed;
    std::fill_n(printed.begin(), row.count, print.at(kWhole));
    for (std::size_t k = 0; k < burnt_.count; ++k) printed[burnt_.place[k]] = print.at(light_[k]);
    for (const PrintShape& shape : job_.near) {
      for (std::size_t i = 0; i < row.count; ++i) {
        const double x = static_cast<double>(row.x[i]) + job_.burn.column;
        const double y = static_cast<double>(row.y[i]) + job_.burn.row;
        const auto covered =
            static_cast<float>(std::clamp(0.5 - shape.outside(x, y) / sample_nodes_, 0.0, 1.0));
        gray[i] += covered * shape.ink * (printed[i] - gray[i]);
      }
    }
  }

  /// Shares of the fluence that cuts.
  void sharesAt(const RowValues& x, const RowValues& y, RowValues& shares) const {
    splineValues(burn_, weights_, x, y, burnt_.count, shares);
    for (std::size_t k = 0; k < burnt_.count; ++k) shares[k] = share_per_fluence_ * shares[k];
  }

  void readShares() {
    sharesAt(burnt_.x, burnt_.y, light_);
    if constexpr (kScorched) {
      for (std::size_t k = 0; k < burnt_.count; ++k)
        open_[burnt_.place[k]] = openAt(light_[k], burnt_.x[k], burnt_.y[k]);
    }
  }

  /// Follows the lines of sight through the board. The burn is deep from the face that they enter by: board
  /// is met below it. Depth is taken as straight between slices, so the share is exact where walls are.
  void followSight() {
    const ObliqueSight& sight = *job_.oblique;
    const std::size_t count = burnt_.count;
    RowValues x, y, shares;
    RowValues above, within;  // How far a line is within the board, in thicknesses; < 0 within the burn.
    std::fill_n(light_.begin(), count, 0.0F);
    for (int i = 0; i <= sight.slices; ++i) {
      const auto down = static_cast<float>(i);
      for (std::size_t k = 0; k < count; ++k) {
        x[k] = burnt_.x[k] + down * (slice_at_origin_.x() + slice_per_node_ * burnt_.x[k]);
        y[k] = burnt_.y[k] + down * (slice_at_origin_.y() + slice_per_node_ * burnt_.y[k]);
      }
      sharesAt(x, y, shares);
      for (std::size_t k = 0; k < count; ++k) within[k] = down * per_slice_ - sight.depth.at(shares[k]);
      if (i > 0) addAboveZero(above, within, per_slice_, count, light_);
      std::swap(above, within);
      if constexpr (kScorched) {
        for (std::size_t k = 0; k < count; ++k) {
          float& open = open_[burnt_.place[k]];
          if (i == 0 || open > 0.0F) open = std::min(i == 0 ? 1.0F : open, openAt(shares[k], x[k], y[k]));
        }
      }
    }
  }

  [[nodiscard]] Eigen::Vector2f displacement(float x, float y) const {
    const Roughness& rough = *job_.rough;
    const auto scale = static_cast<float>(rough.fields_per_node);
    const float field_x = x * scale + to_field_x_;
    const float field_y = y * scale + to_field_y_;
    return rough.rms_nodes * Eigen::Vector2f(rough.window_x.at(field_x, field_y, weights_),
                                             rough.window_y.at(field_x, field_y, weights_));
  }

  /// Scorch darkens what is not open.
  void scorch(const SampleRow& row, RowValues& gray) const {
    RowValues x, y, fluence;
    for (std::size_t i = 0; i < row.count; ++i) {
      x[i] = row.x[i] + to_charred_x_;
      y[i] = row.y[i] + to_charred_y_;
    }
    splineValues({job_.charred.nodes.data(), job_.charred.columns}, weights_, x, y, row.count, fluence);
    for (std::size_t i = 0; i < row.count; ++i) {
      const float scorch = std::clamp(job_.scorch.per_fluence * fluence[i], 0.0F, 1.0F);
      const float dark = gray[i] * (1.0F - job_.scorch.darkening * scorch);
      gray[i] = dark + open_[i] * (job_.open_gray - dark);
    }
  }

  /// Share of a sample around the place that is cut through. Light jumps where the scorched board ends:
  /// sampled points alone would misplace that edge by up to half a sample.
  [[nodiscard]] float openAt(float share, float at_x, float at_y) const {
    if (!(share > kSurelyWhole)) return 0.0F;
    const Around place(burn_.first, static_cast<std::size_t>(burn_.columns), at_x, at_y);
    const float slope_x =
        splineValue(place.nodes, place.stride, splineSlopeWeights(place.x), weights_.at(place.y));
    const float slope_y =
        splineValue(place.nodes, place.stride, weights_.at(place.x), splineSlopeWeights(place.y));
    const float change = share_per_fluence_ * static_cast<float>(sample_nodes_) *
                         std::sqrt(slope_x * slope_x + slope_y * slope_y);
    return std::clamp(0.5F + (share - 1.0F) / std::max(change, 1e-6F), 0.0F, 1.0F);
  }

  static constexpr float kSurelyWhole = 0.1F;
  static constexpr float kWhole = kOblique ? 1.0F : 0.0F;  ///< What whole board has for `light_`.

  const TileJob& job_;
  const SplineWeightTable& weights_;
  SplineNodes burn_;  ///< Null where nothing was burnt.
  float share_per_fluence_;
  double sample_nodes_;
  Eigen::Vector2f slice_at_origin_{Eigen::Vector2f::Zero()};  ///< Way through a slice from the origin.
  float slice_per_node_{}, per_slice_{};
  float to_field_x_{}, to_field_y_{};
  float to_charred_x_, to_charred_y_;  ///< Shift from the burn's window to that of what scorched it.
  // Scratch for the row that is painted.
  Burnt burnt_;
  /// What the tables of light take, of the burnt places: the share of the fluence that cuts, or, aslant, the
  /// share of the thickness that is left.
  RowValues light_;
  RowValues open_;  ///< Share of the sample around each place that meets no board; with scorch alone.
};

}  // namespace kerfbench::twin
