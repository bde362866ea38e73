// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "hil/camera/tile_source.h"
#include "hil/camera/twin/sheet_feed.h"
#include "twin/camera/camera.h"

namespace kerfbench::camera {

struct TwinTileOptions {
  int threads{1};          ///< The tiles are the same at any number.
  double overlap_mm{3.0};  ///< Overlap of neighbouring tiles; >= 0 and less than the field of the camera.
  double border_mm{2.0};   ///< Around the boxes of interest; >= 0.
  /// Every unit is laid on the table a little askew, differently: up to this far in each direction and angle
  /// about the middle of the unit. Inspection must find it by its marks.
  double lay_shift_mm{1.0};
  double lay_angle_rad{0.3 * std::numbers::pi / 180.0};
  twin::InspectionTableDescription table{};  ///< The tiles are taken where it is, and read where it says.
  double turn_rad{0.0};  ///< Turn of each unit in addition, about its middle; within ±pi.
  std::uint64_t seed{1};
  /// Cover the whole bounds of each unit, marks included; else only tiles that meet a box of interest, blind
  /// to a stray cut elsewhere.
  bool everything{true};
};

/// Tiles of the modelled kerf camera over each unit in turn, row by row of an even grid.
///
/// The web is parted halfway between the units, where the boxes of interest leave room for that: what was
/// burnt on the neighbour's side is not seen.
class TwinTileSource final : public TilesMeanwhile {
 public:
  /// `interest_S_mm`: boxes around the dieline's entities, in S; the printed marks are added to them. `sheet`
  /// must outlive this. @throws std::invalid_argument if there is nothing to look at or an option is out of
  /// range.
  TwinTileSource(twin::KerfCamera camera, const twin::Sheet& sheet,
                 const std::vector<Eigen::AlignedBox2d>& interest_S_mm, const TwinTileOptions& options);
  /// Pieces of a web that still runs, parted at partings_S_mm(). The tiles are those of the whole sheet.
  TwinTileSource(twin::KerfCamera camera, std::shared_ptr<SheetFeed> feed,
                 const std::vector<Eigen::AlignedBox2d>& interest_S_mm, const TwinTileOptions& options);

  std::vector<KerfTile> nextBatch(std::size_t max) override;
  void close() override { feed_->close(); }
  /// Where the web is parted behind each unit but the last, x in S of unit 0; nullopt if units reach into
  /// each other.
  [[nodiscard]] std::optional<std::vector<double>> partings_S_mm() const;
  [[nodiscard]] std::size_t size() const { return plan_.size(); }
  /// Pose of a unit on the table: the truth, for tests.
  [[nodiscard]] const Eigen::Isometry2d& lay(int unit) const {
    return lay_.at(static_cast<std::size_t>(unit));
  }
  /// Where the camera is when the table says p_TV of the tile with this number: the truth, for tests.
  [[nodiscard]] Eigen::Vector2d takenAt(std::size_t index) const;

 private:
  struct Place {
    int unit{};
    Eigen::Vector2d p_TV_mm{Eigen::Vector2d::Zero()};
  };

  [[nodiscard]] bool isLastOfUnit(std::size_t index) const {
    return index + 1 == plan_.size() || plan_[index + 1].unit != plan_[index].unit;
  }

  twin::KerfCamera camera_;
  std::shared_ptr<SheetFeed> feed_;
  std::shared_ptr<const twin::Sheet> sheet_;  ///< Piece with the unit whose tiles are being taken.
  int threads_;
  std::uint64_t seed_;
  twin::InspectionTableDescription table_;
  std::vector<Eigen::Isometry2d> lay_;  ///< X_TS of each unit.
  std::vector<twin::PieceSpan> pieces_;
  std::vector<Place> plan_;
  std::size_t next_{0};
};

}  // namespace kerfbench::camera
