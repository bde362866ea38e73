// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/calibrate/marks/marked_sheet.h"

#include <cmath>
#include <utility>

#include "hil/camera/kerf_tile.h"
#include "tests/hil/vision/synthetic.h"

namespace kerfbench::calibrate::test {

using Eigen::Vector2d;

MarkedSheet::MarkedSheet(int columns, int rows, int first_number) {
  job.name = "test";
  job.machine = "none";
  job.date = "2026-11-22";
  job.size_mm = 5.0;
  job.p_SW_mm = {3.0, -2.0};
  const Vector2d half_mm = 3.125 * Vector2d(columns - 1, rows - 1);
  std::vector<Vector2d> places_mm;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      places_mm.emplace_back(6.25 * Vector2d(column, row) - half_mm);
  }
  job.marks = numbered(places_mm, first_number);
  for (const double x : {-1.0, 0.1, 1.0}) {
    for (const double y : {-1.0, 1.0})
      job.print.push_back({job.p_SW_mm + Vector2d(x * (half_mm.x() + 7.0), y * (half_mm.y() + 7.0)), 3.0});
  }
}

void MarkedSheet::burn(twin::Sheet& sheet, const Vector2d& from_mm, const Vector2d& to_mm) const {
  vision::test::TwinCut cut;
  cut.board = board;
  cut.burn(sheet, from_mm, to_mm, share);
}

void MarkedSheet::burnMarks(twin::Sheet& sheet) const {
  constexpr int kParts = 20;  // The line is burnt in parts: a head with errors bends lines.
  for (const WantedMark& mark : job.marks) {
    std::vector<MarkStroke> strokes;
    for (const MarkStroke& arm : markArms(job.size_mm)) strokes.push_back(arm);
    for (const MarkStroke& tick : markTicks(mark.number, job.size_mm)) strokes.push_back(tick);
    for (std::size_t s = 0; s < strokes.size(); ++s) {
      if (skipped.contains({mark.number, static_cast<int>(s)})) continue;
      const auto at = [&](int i) {
        const double t = static_cast<double>(i) / kParts;
        return head(job.wanted_S_mm(mark) + (1.0 - t) * strokes[s].from_mm + t * strokes[s].to_mm);
      };
      for (int i = 0; i < kParts; ++i) burn(sheet, at(i), at(i + 1));
    }
  }
}

std::vector<camera::KerfTile> MarkedSheet::tiles() {
  twin::Sheet sheet(board);
  burnMarks(sheet);
  if (also) also(*this, sheet);
  PrintLayout print;
  print.units = 1;
  print.pitch_mm = 500.0;
  print.marks = job.print;
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const WantedMark& mark : job.marks) {
    const Vector2d centre_mm = head(job.wanted_S_mm(mark));
    const Vector2d reach_mm = Vector2d::Constant(0.5 * kMarkReach * job.size_mm);
    boxes.emplace_back(centre_mm - reach_mm, centre_mm + reach_mm);
  }
  camera::TwinTileOptions options;
  options.threads = threads;
  options.seed = seed;
  camera::TwinTileSource source(twin::KerfCamera(camera, print, seed), sheet, boxes, options);
  std::vector<camera::KerfTile> all;
  for (auto some = source.nextBatch(8); !some.empty(); some = source.nextBatch(8))
    std::ranges::move(some, std::back_inserter(all));
  return all;
}

FieldPictures MarkedSheet::find() { return find(tiles()); }

FieldPictures MarkedSheet::find(std::vector<camera::KerfTile> some) const {
  vision::test::ReadyTiles source(std::move(some));
  FieldSearchOptions options;
  options.size_mm = job.size_mm;
  options.beam_radius_mm = vision::test::kBeamRadiusMm;
  options.threads = threads;
  return findFieldMarks(source, vision::test::calibrationOf(camera), job.print, options);
}

}  // namespace kerfbench::calibrate::test
