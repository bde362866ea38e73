// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/verify_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <stdexcept>

#include "hil/calibrate/marks/mark_code.h"
#include "hil/calibrate/marks/mark_job.h"
#include "hil/calibrate/marks/mark_pattern.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kFull = 0.35;  // Fill of a sheet, of what a grid holds; random squares jam at 0.56.
constexpr double kApartFromMarked = 0.25;  // Least distance from a mark of the fit, in sizes of a mark.
constexpr std::uint64_t kMostSheets = 4096;

int mostOnSheet(const AlignedBox2d& field_mm, double mark_size_mm) {
  const Vector2d rows = field_mm.sizes() / (kMarkPitch * mark_size_mm);
  const double grid = (std::floor(rows.x()) + 1.0) * (std::floor(rows.y()) + 1.0);
  return static_cast<int>(std::clamp(kFull * grid, 1.0, static_cast<double>(kMarkNumbers)));
}

}  // namespace

std::vector<std::vector<Vector2d>> verifySheets(const AlignedBox2d& field_mm, const VerifyPlaces& request) {
  if (field_mm.isEmpty() || !(request.mark_size_mm > 0.0) || request.count < 1)
    throw std::invalid_argument("marks: nothing to verify by: no field, no size or no count");
  const int most = mostOnSheet(field_mm, request.mark_size_mm);
  const int sheets = (request.count + most - 1) / most;
  const double from_marked_mm = kApartFromMarked * request.mark_size_mm;
  std::vector<Vector2d> middles;
  std::ranges::copy_if(request.middles, std::back_inserter(middles), [&](const Vector2d& middle) {
    return field_mm.contains(middle) && std::ranges::none_of(request.marked, [&](const Vector2d& marked) {
             return marksApart_mm(marked, middle) < from_marked_mm;
           });
  });
  std::vector<std::vector<Vector2d>> places_mm;
  for (int sheet = 0; sheet < sheets; ++sheet) {
    RandomPlaces places;
    places.count = request.count * (sheet + 1) / sheets - request.count * sheet / sheets;
    places.apart_mm = kMarkPitch * request.mark_size_mm;
    places.known = request.marked;
    places.from_known_mm = from_marked_mm;
    for (auto i = static_cast<std::size_t>(sheet); i < middles.size(); i += static_cast<std::size_t>(sheets))
      places.favoured.push_back(middles[i]);
    places.seed = kMostSheets * request.seed + static_cast<std::uint64_t>(sheet);
    places_mm.push_back(randomPlaces(field_mm, places));
  }
  return places_mm;
}

}  // namespace kerfbench::calibrate
