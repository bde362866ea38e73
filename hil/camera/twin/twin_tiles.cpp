// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/twin_tiles.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/camera/kerf_tile.h"
#include "twin/base/random.h"

namespace kerfbench::camera {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr std::uint64_t kLaySeed = 0x71c4e0b9a52f3d86ULL;
constexpr std::uint64_t kTableSeed = 0x1d9f53b7c06e28a4ULL;

AlignedBox2d widened(const AlignedBox2d& box, double by_mm) {
  return {box.min() - Vector2d::Constant(by_mm), box.max() + Vector2d::Constant(by_mm)};
}

/// The upright box around the image of a box.
AlignedBox2d imageOf(const AlignedBox2d& box, const Eigen::Isometry2d& X) {
  AlignedBox2d image;
  for (const auto corner :
       {AlignedBox2d::BottomLeft, AlignedBox2d::BottomRight, AlignedBox2d::TopLeft, AlignedBox2d::TopRight}) {
    image.extend(X * box.corner(corner));
  }
  return image;
}

/// Begins of the fewest fields of length `field` that cover [from, to] evenly with the overlap asked for.
std::vector<double> covering(double from, double to, double field, double overlap) {
  const double rest = std::max(to - from - field, 0.0);
  const auto steps = static_cast<int>(std::ceil(rest / (field - overlap) - 1e-9));
  std::vector<double> begins;
  if (steps == 0) begins.push_back(0.5 * (from + to - field));
  for (int i = 0; steps > 0 && i <= steps; ++i) begins.push_back(from + rest * i / steps);
  return begins;
}

void checkOptions(const TwinTileOptions& options, const AlignedBox2d& field) {
  std::string faults;
  const auto require = [&faults](bool fine, const char* rule) {
    if (!fine) faults += (faults.empty() ? "tiles: " : "; ") + std::string(rule);
  };
  require(options.overlap_mm >= 0.0 && options.overlap_mm < field.sizes().minCoeff(),
          "overlap_mm must be >= 0 and less than the camera's field");
  require(options.border_mm >= 0.0 && std::isfinite(options.border_mm), "border_mm must be >= 0");
  require(options.lay_shift_mm >= 0.0 && std::isfinite(options.lay_shift_mm), "lay_shift_mm must be >= 0");
  require(std::abs(options.lay_angle_rad) <= 0.5 * std::numbers::pi,
          "lay_angle_rad must be within a right angle");
  require(std::abs(options.turn_rad) <= std::numbers::pi, "turn_rad must be within half a turn");
  if (!faults.empty()) throw std::invalid_argument(faults);
}

std::shared_ptr<SheetFeed> fedWith(const twin::Sheet& sheet) {
  auto feed = std::make_shared<SheetFeed>(1);
  feed->end({std::shared_ptr<void>(), &sheet});
  return feed;
}

}  // namespace

TwinTileSource::TwinTileSource(twin::KerfCamera camera, const twin::Sheet& sheet,
                               const std::vector<AlignedBox2d>& interest_S_mm, const TwinTileOptions& options)
    : TwinTileSource(std::move(camera), fedWith(sheet), interest_S_mm, options) {}

TwinTileSource::TwinTileSource(twin::KerfCamera camera, std::shared_ptr<SheetFeed> feed,
                               const std::vector<AlignedBox2d>& interest_S_mm, const TwinTileOptions& options)
    : camera_(std::move(camera)),
      feed_(std::move(feed)),
      threads_(options.threads),
      seed_(options.seed),
      table_(options.table) {
  const AlignedBox2d field_V = camera_.field();
  checkOptions(options, field_V);
  const PrintLayout& print = camera_.print();
  std::vector<AlignedBox2d> boxes;
  AlignedBox2d unit_bounds;
  AlignedBox2d bounds;
  const auto add = [&](const AlignedBox2d& box) {
    if (box.isEmpty()) return;
    unit_bounds.extend(box);
    boxes.push_back(widened(box, options.border_mm));
    bounds.extend(boxes.back());
  };
  for (const AlignedBox2d& box : interest_S_mm) add(box);
  for (const RegistrationMark& mark : print.marks) {
    add(widened({mark.p_SM_mm, mark.p_SM_mm}, 0.5 * mark.diameter_mm));
  }
  if (boxes.empty() || !bounds.min().allFinite() || !bounds.max().allFinite()) {
    throw std::invalid_argument("tiles: nothing to look at");
  }
  if (options.everything) boxes = {bounds};

  for (int unit = 0; unit < print.units; ++unit) {
    const CounterRandom random(options.seed ^ kLaySeed, static_cast<std::uint64_t>(unit));
    const auto within = [&](std::uint64_t index, double limit) {
      return limit * (2.0 * random.uniform(index) - 1.0);
    };
    const Vector2d shift_mm(within(0, options.lay_shift_mm), within(1, options.lay_shift_mm));
    const Vector2d middle = bounds.center();
    const Eigen::Isometry2d X_TS = Eigen::Translation2d(shift_mm + middle) *
                                   Eigen::Rotation2Dd(options.turn_rad + within(2, options.lay_angle_rad)) *
                                   Eigen::Translation2d(-middle);
    lay_.push_back(X_TS);
    twin::PieceSpan piece;
    if (unit_bounds.sizes().x() < print.pitch_mm) {
      // Unit 0 leads: it has no neighbour at larger x, the last one has none at smaller x.
      if (unit > 0) piece.max_x_S_mm = middle.x() + 0.5 * print.pitch_mm;
      if (unit + 1 < print.units) piece.min_x_S_mm = middle.x() - 0.5 * print.pitch_mm;
    }
    pieces_.push_back(piece);

    AlignedBox2d bounds_T;
    std::vector<AlignedBox2d> boxes_T;
    for (const AlignedBox2d& box : boxes) {
      boxes_T.push_back(imageOf(box, X_TS));
      bounds_T.extend(boxes_T.back());
    }
    const Vector2d field = field_V.sizes();
    for (const double y : covering(bounds_T.min().y(), bounds_T.max().y(), field.y(), options.overlap_mm)) {
      for (const double x : covering(bounds_T.min().x(), bounds_T.max().x(), field.x(), options.overlap_mm)) {
        const AlignedBox2d seen(Vector2d(x, y), Vector2d(x, y) + field);
        if (std::none_of(boxes_T.begin(), boxes_T.end(),
                         [&](const AlignedBox2d& box) { return seen.intersects(box); }))
          continue;
        plan_.push_back({unit, seen.min() - field_V.min()});
      }
    }
  }
}

Vector2d TwinTileSource::takenAt(std::size_t index) const {
  const CounterRandom random(seed_ ^ kTableSeed, index);
  const Vector2d& told_mm = plan_[index].p_TV_mm;
  return (1.0 + table_.scale) * told_mm +
         Vector2d(table_.bow_x.at(told_mm.y()), table_.bow_y.at(told_mm.x())) +
         table_.step_mm * Vector2d(random.normal(0), random.normal(1));
}

std::optional<std::vector<double>> TwinTileSource::partings_S_mm() const {
  std::vector<double> partings;
  for (std::size_t unit = 0; unit + 1 < pieces_.size(); ++unit) {
    const double begin_x_mm = pieces_[unit].min_x_S_mm;
    if (!std::isfinite(begin_x_mm)) return std::nullopt;
    partings.push_back(begin_x_mm - static_cast<double>(unit) * camera_.print().pitch_mm);
  }
  return partings;
}

std::vector<KerfTile> TwinTileSource::nextBatch(std::size_t max) {
  if (next_ == plan_.size()) return {};
  if (next_ == 0 || isLastOfUnit(next_ - 1)) sheet_ = feed_->take();
  if (!sheet_) return {};
  std::size_t count = 1;
  while (count < max && !isLastOfUnit(next_ + count - 1)) ++count;
  std::vector<KerfTile> tiles(count);
  base::forEachIndex(count, threads_, [&](std::size_t i) {
    const std::size_t index = next_ + i;
    const Place& place = plan_[index];
    const auto unit = static_cast<std::size_t>(place.unit);
    tiles[i] = {camera_.render(*sheet_, place.unit, takenAt(index), lay_[unit], pieces_[unit]), place.p_TV_mm,
                place.unit, isLastOfUnit(index)};
  });
  next_ += count;
  return tiles;
}

}  // namespace kerfbench::camera
