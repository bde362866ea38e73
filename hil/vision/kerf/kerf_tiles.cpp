// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/camera/kerf_tile.h"
#include "hil/vision/image/brightness_scan.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

constexpr double kSameMarkMm = 0.5;  // Largest distance of one mark in two tiles.
/// Largest distance of a unit from its nominal place, lever arm of its angle included.
constexpr double kTableShiftMm = 12.0;
constexpr double kMaxTableAngleRad = 0.03;
constexpr double kDisagreementMm = 0.1;
/// A disc so near to where a mark should be is that mark, and lies elsewhere; see worstMisfit().
constexpr double kFarthestMarkMm = 2.0;
/// Marks of which one may have moved; more make the unit's place doubtful.
constexpr std::size_t kMovedMarks = 4;
constexpr double kMostCells = 256.0;  // Most cells of the index, each way.

struct TableMark {
  Eigen::Vector2d p_T_mm;
  double from_middle_mm;
  double sigma_mm;
};

/// One entry per mark of the table: from the tile with its middle nearest.
std::vector<TableMark> uniqueMarks(const std::vector<TileView>& tiles) {
  std::vector<TableMark> unique;
  for (const TileView& view : tiles) {
    for (const FoundMark& mark : view.marks) {
      const Eigen::Vector2d p_T_mm = view.tile.p_TV_mm + mark.p_mm;
      const TableMark here{p_T_mm, (p_T_mm - view.centre_T_mm).norm(), mark.sigma_mm};
      const auto same = std::find_if(unique.begin(), unique.end(), [&](const TableMark& other) {
        return (other.p_T_mm - p_T_mm).norm() < kSameMarkMm;
      });
      if (same == unique.end()) {
        unique.push_back(here);
      } else if (here.from_middle_mm < same->from_middle_mm) {
        *same = here;
      }
    }
  }
  return unique;
}

/// For each mark of the print the disc nearest to where it should be, if one lies near.
std::vector<SeenMark> seenMarks(const std::vector<TableMark>& discs, const PrintLayout& print,
                                const PlaneMotion& motion, double mark_sigma_mm) {
  std::vector<SeenMark> seen;
  for (std::size_t i = 0; i < print.marks.size(); ++i) {
    const Eigen::Vector2d& p_mm = print.marks[i].p_SM_mm;
    const Eigen::Vector2d expected_mm = motion * p_mm;
    const auto nearest = std::ranges::min_element(
        discs, {}, [&](const TableMark& disc) { return (disc.p_T_mm - expected_mm).squaredNorm(); });
    if ((nearest->p_T_mm - expected_mm).norm() < kFarthestMarkMm)
      seen.push_back({i, {p_mm, nearest->p_T_mm, std::hypot(nearest->sigma_mm, mark_sigma_mm)}});
  }
  return seen;
}

}  // namespace

TileView viewTile(camera::KerfTile tile, const CameraCalibration& calibration,
                  const std::vector<double>& diameters_mm) {
  TileView view;
  view.tile = std::move(tile);
  const GrayImage& image = view.tile.image;
  view.background.emplace(image);
  view.noise_gray = view.background->noise();
  view.marks = findMarks(image, calibration, *view.background, diameters_mm);
  const Eigen::Vector2d middle(0.5 * (image.width - 1), 0.5 * (image.height - 1));
  view.centre_T_mm = view.tile.p_TV_mm + calibration.planeFromPixel(middle);
  for (const double x : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) {
      const Eigen::Vector2d corner(x * (image.width - 1), y * (image.height - 1));
      const Eigen::Vector2d p_T_mm = view.tile.p_TV_mm + calibration.planeFromPixel(corner);
      view.half_diagonal_mm = std::max(view.half_diagonal_mm, (p_T_mm - view.centre_T_mm).norm());
    }
  }
  return view;
}

std::optional<UnitPlace> placeUnit(const std::vector<TileView>& tiles, const TileIndex& index,
                                   const WantedUnit& wanted, const CameraCalibration& calibration,
                                   std::vector<std::string>& problems) {
  const PrintLayout& print = *wanted.print;
  const std::string name = "unit " + std::to_string(wanted.unit) + ": ";
  const std::vector<TableMark> marks = uniqueMarks(tiles);
  std::vector<Eigen::Vector2d> seen;
  for (const TableMark& mark : marks) seen.push_back(mark.p_T_mm);
  if (seen.empty()) {
    problems.push_back(name + "no registration mark found in its tiles");
    return std::nullopt;
  }
  PrintLayout alone = print;
  alone.units = 1;
  ConstellationQuery query;
  query.print = &alone;
  query.max_angle_rad = kMaxTableAngleRad;
  query.max_shift_mm = kTableShiftMm;
  double border_px = 0.0;
  for (const RegistrationMark& mark : print.marks) {
    border_px = std::max(border_px, 1.1 * markBorderPx(0.5 * mark.diameter_mm / calibration.pitchMm()));
  }
  query.in_view = [&](const Eigen::Vector2d& p_T_mm) { return index.best(p_T_mm, border_px) != nullptr; };
  const std::optional<Constellation> found = matchConstellation(seen, query);
  if (!found || found->matched < 2) {
    problems.push_back(name + "its registration marks do not fit the print layout (" +
                       std::to_string(seen.size()) + " discs seen, " +
                       std::to_string(found ? found->matched : 0) + " fit)");
    return std::nullopt;
  }
  const std::vector<SeenMark> all = seenMarks(marks, print, found->motion, wanted.mark_sigma_mm);
  std::vector<MarkPair> pairs;
  for (const SeenMark& mark : all) {
    if ((mark.pair.q_mm - found->motion * mark.pair.p_mm).norm() < query.tolerance_mm)
      pairs.push_back(mark.pair);
  }
  if (pairs.size() < 2) {
    problems.push_back(name + "fewer than two of its registration marks lie where the print has them");
    return std::nullopt;
  }
  const MotionFit fit = fitMotionRobust(pairs, found->motion, kDisagreementMm);
  if (fit.pairs < 2) {
    problems.push_back(name + "its registration marks disagree with each other");
    return std::nullopt;
  }
  // One of many may be stained. Of three, nobody knows which one moved.
  const std::size_t moved = pairs.size() - static_cast<std::size_t>(fit.pairs);
  if (kMovedMarks * moved > pairs.size()) {
    problems.push_back(name + std::to_string(moved) + " of " + std::to_string(pairs.size()) +
                       " registration marks do not lie to the others as the print has them");
  }
  if (2 * fit.pairs < found->expected) {
    problems.push_back(name + "only " + std::to_string(fit.pairs) + " of " + std::to_string(found->expected) +
                       " registration marks could be used");
  }
  return UnitPlace{fit.motion, fit.rms_mm, fit.pairs, fit.covariance, all};
}

void shareLight(std::vector<TileView>& tiles) {
  std::vector<const Background*> pictures;
  for (const TileView& view : tiles) pictures.push_back(&*view.background);
  if (tiles.empty()) return;
  const GrayImage& first = tiles.front().tile.image;
  const LightField light(pictures, first.width, first.height);
  for (TileView& view : tiles) view.light = light;
}

TileIndex::TileIndex(const std::vector<TileView>& tiles, const CameraCalibration& calibration)
    : tiles_(tiles), calibration_(calibration) {
  for (const TileView& view : tiles) {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(view.half_diagonal_mm);
    box_T_mm_.extend(Eigen::AlignedBox2d(view.centre_T_mm - half, view.centre_T_mm + half));
    cell_mm_ = std::max(cell_mm_, 0.25 * view.half_diagonal_mm);
  }
  if (tiles.empty()) return;
  const auto cellsOver = [&](double mm) { return 1 + static_cast<int>(mm / cell_mm_); };
  cell_mm_ = std::max(cell_mm_, box_T_mm_.sizes().maxCoeff() / kMostCells);
  columns_ = cellsOver(box_T_mm_.sizes().x());
  rows_ = cellsOver(box_T_mm_.sizes().y());
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(tiles[t].half_diagonal_mm);
    const Eigen::Vector2d low = (tiles[t].centre_T_mm - half - box_T_mm_.min()) / cell_mm_;
    const Eigen::Vector2d high = (tiles[t].centre_T_mm + half - box_T_mm_.min()) / cell_mm_;
    for (int y = std::clamp(static_cast<int>(low.y()), 0, rows_ - 1);
         y <= std::min(rows_ - 1, static_cast<int>(high.y())); ++y) {
      for (int x = std::clamp(static_cast<int>(low.x()), 0, columns_ - 1);
           x <= std::min(columns_ - 1, static_cast<int>(high.x())); ++x) {
        cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)]
            .push_back(t);
      }
    }
  }
}

std::span<const std::uint32_t> TileIndex::near(const Eigen::Vector2d& p_T_mm) const {
  if (!box_T_mm_.contains(p_T_mm)) return {};
  const Eigen::Vector2d cell = (p_T_mm - box_T_mm_.min()) / cell_mm_;
  const int x = std::min(columns_ - 1, static_cast<int>(cell.x()));
  const int y = std::min(rows_ - 1, static_cast<int>(cell.y()));
  return cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                static_cast<std::size_t>(x)];
}

const TileView* TileIndex::best(const Eigen::Vector2d& p_T_mm, double border_px) const {
  const TileView* best = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : near(p_T_mm)) {
    const TileView& view = tiles_[t];
    const double distance_mm = (p_T_mm - view.centre_T_mm).norm();
    if (distance_mm > view.half_diagonal_mm || distance_mm >= nearest) continue;
    if (!calibration_.pixelIfSeen(p_T_mm - view.tile.p_TV_mm, border_px)) continue;
    nearest = distance_mm;
    best = &view;
  }
  return best;
}

std::vector<const TileView*> TileIndex::seeing(const Eigen::Vector2d& p_T_mm, double border_px) const {
  std::vector<const TileView*> views;
  for (const std::uint32_t t : near(p_T_mm)) {
    if (calibration_.pixelIfSeen(p_T_mm - tiles_[t].tile.p_TV_mm, border_px)) views.push_back(&tiles_[t]);
  }
  std::ranges::stable_sort(views, {},
                           [&](const TileView* view) { return (p_T_mm - view->centre_T_mm).norm(); });
  return views;
}

}  // namespace kerfbench::vision
