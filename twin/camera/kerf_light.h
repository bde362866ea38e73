// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "twin/camera/board_field.h"
#include "twin/camera/camera.h"
#include "twin/camera/spline_weights.h"
#include "twin/sheet/sheet.h"

/// Transmission of the back light through a burnt sheet; of use to KerfCamera alone.
namespace kerfbench::twin {

/// Grey level of the back light through board that absorbed a share of the fluence that cuts, where uncut
/// board transmits `transmission`.
class LightTable {
 public:
  LightTable(const Sheet& sheet, double transmission) {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const double share = static_cast<double>(i) / (static_cast<double>(table_.size()) - 1.0);
      const double depth = sheet.depthCurve().depthAt(share * sheet.board().cut_fluence_j_mm2);
      table_[i] = static_cast<float>(kOpenKerfGray * std::pow(transmission, 1.0 - depth));
    }
  }
  [[nodiscard]] float at(float share) const {
    const float place = (share < 1.0F ? share : 1.0F) * static_cast<float>(kSteps);
    return table_[static_cast<std::size_t>(static_cast<int>(place + 0.5F))];
  }

 private:
  static constexpr std::size_t kSteps = 4096;
  std::array<float, kSteps + 1> table_{};
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
};

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
  LightTable board;
  LightTable print;
  float share_per_fluence;
  double piece_min_nodes;
  double piece_max_nodes;
  std::vector<PrintShape> print_shapes;
  Scorch scorch;
  Window burn;
  Window charred;  ///< Coefficients that scorched the block: the burn's window less the shift.
  std::vector<PrintShape> near;
  std::optional<Roughness> rough;
};

/// Grey levels of the places of one block.
template <bool kScorched, bool kRough>
class BlockPainter {
 public:
  BlockPainter(const TileJob& job, const SplineWeightTable& weights, bool burnt, double sample_nodes)
      : job_(job),
        weights_(weights),
        burn_(burnt ? job.burn.nodes.data() : nullptr),
        columns_(static_cast<std::size_t>(job.burn.columns)),
        share_per_fluence_(job.share_per_fluence),
        sample_nodes_(sample_nodes) {
    const double x = job.burn.column - job.scorch.shift_nodes.x() - job.charred.column;
    const double y = job.burn.row - job.scorch.shift_nodes.y() - job.charred.row;
    to_charred_x_ = static_cast<float>(x);
    to_charred_y_ = static_cast<float>(y);
    if constexpr (kRough) {
      const Eigen::Vector2d to_field = origin() * job.rough->fields_per_node - job.rough->window_x.origin();
      to_field_x_ = static_cast<float>(to_field.x());
      to_field_y_ = static_cast<float>(to_field.y());
    }
  }
  [[nodiscard]] Eigen::Vector2d origin() const { return {job_.burn.column, job_.burn.row}; }
  /// Grey of a place that counts from the first node of the burn's window.
  [[nodiscard]] float at(float x, float y) const {
    if constexpr (kRough) {
      const Eigen::Vector2f off = displacement(x, y);
      return grayOf(x, y, x + off.x(), y + off.y());
    } else {
      return grayOf(x, y, x, y);
    }
  }

 private:
  /// Grey from print and scorch at a place and from depth at another place near it.
  [[nodiscard]] float grayOf(float x, float y, float depth_x, float depth_y) const {
    const float share =
        burn_ == nullptr ? 0.0F : share_per_fluence_ * fluence(Around(burn_, columns_, depth_x, depth_y));
    float gray = job_.board.at(share);
    for (const PrintShape& shape : job_.near) {
      const double outside =
          shape.outside(static_cast<double>(x) + job_.burn.column, static_cast<double>(y) + job_.burn.row) /
          sample_nodes_;
      const auto covered = static_cast<float>(std::clamp(0.5 - outside, 0.0, 1.0));
      gray += covered * shape.ink * (job_.print.at(share) - gray);
    }
    if constexpr (kScorched) return scorched(gray, share, x, y, depth_x, depth_y);
    return gray;
  }

  [[nodiscard]] Eigen::Vector2f displacement(float x, float y) const {
    const Roughness& rough = *job_.rough;
    const auto scale = static_cast<float>(rough.fields_per_node);
    const float field_x = x * scale + to_field_x_;
    const float field_y = y * scale + to_field_y_;
    return rough.rms_nodes * Eigen::Vector2f(rough.window_x.at(field_x, field_y, weights_),
                                             rough.window_y.at(field_x, field_y, weights_));
  }

  [[nodiscard]] float fluence(const Around& place) const {
    return splineValue(place.nodes, place.stride, weights_.at(place.x), weights_.at(place.y));
  }

  [[nodiscard]] float scorched(float gray, float share, float x, float y, float depth_x,
                               float depth_y) const {
    const Around cause(job_.charred.nodes.data(), static_cast<std::size_t>(job_.charred.columns),
                       x + to_charred_x_, y + to_charred_y_);
    const float scorch = std::clamp(job_.scorch.per_fluence * fluence(cause), 0.0F, 1.0F);
    const float dark = gray * (1.0F - job_.scorch.darkening * scorch);
    if (!(share > kSurelyWhole)) return dark;
    return dark + through(share, Around(burn_, columns_, depth_x, depth_y)) *
                      (static_cast<float>(kOpenKerfGray) - dark);
  }

  /// Share of a sample around the place that is cut through. Light jumps where the scorched board ends:
  /// sampled points alone would misplace that edge by up to half a sample.
  [[nodiscard]] float through(float share, const Around& place) const {
    const float slope_x =
        splineValue(place.nodes, place.stride, splineSlopeWeights(place.x), weights_.at(place.y));
    const float slope_y =
        splineValue(place.nodes, place.stride, weights_.at(place.x), splineSlopeWeights(place.y));
    const float change = share_per_fluence_ * static_cast<float>(sample_nodes_) *
                         std::sqrt(slope_x * slope_x + slope_y * slope_y);
    return std::clamp(0.5F + (share - 1.0F) / std::max(change, 1e-6F), 0.0F, 1.0F);
  }

  static constexpr float kSurelyWhole = 0.1F;

  const TileJob& job_;
  const SplineWeightTable& weights_;
  const float* burn_;  ///< Null where nothing was burnt.
  std::size_t columns_;
  float share_per_fluence_;
  double sample_nodes_;
  float to_field_x_{}, to_field_y_{};
  float to_charred_x_, to_charred_y_;  ///< Shift from the burn's window to that of what scorched it.
};

}  // namespace kerfbench::twin
