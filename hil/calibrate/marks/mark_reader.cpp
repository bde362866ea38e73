// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_reader.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "hil/calibrate/marks/mark_pattern.h"
#include "twin/base/image.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

// Share of the way from board to open kerf, over the middle of a slot. What lies between is neither.
constexpr double kTickLight = 0.5;
constexpr double kBoardLight = 0.25;
constexpr double kLook = 0.5 * kTick;  // radius, of half a size
constexpr double kBorder_px = 4.0;

std::optional<double> lightAt(const Vector2d& p_T_mm, double radius_mm, const vision::TileIndex& tiles,
                              const vision::CameraCalibration& calibration, double open_gray) {
  const double radius_px = std::max(1.0, radius_mm / calibration.pitchMm());
  const vision::TileView* view = tiles.best(p_T_mm, radius_px + kBorder_px);
  if (view == nullptr) return std::nullopt;
  const GrayImage& image = view->tile.image;
  const Vector2d pixel = calibration.pixelFromPlane(p_T_mm - view->tile.p_TV_mm);
  double sum = 0.0;
  double count = 0.0;
  for (int r = static_cast<int>(std::ceil(pixel.y() - radius_px)); r <= pixel.y() + radius_px; ++r) {
    for (int c = static_cast<int>(std::ceil(pixel.x() - radius_px)); c <= pixel.x() + radius_px; ++c) {
      if ((Vector2d(c, r) - pixel).norm() > radius_px) continue;
      sum += image.gray(c, r);
      count += 1.0;
    }
  }
  const double board = view->background->at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
  return (sum / count - board) / std::max(1.0, open_gray * view->light.at(pixel) - board);
}

}  // namespace

std::variant<MarkReading, std::string> readTicks(const Cross& cross, const vision::TileIndex& tiles,
                                                 const vision::CameraCalibration& calibration,
                                                 double open_gray) {
  const double half_mm = std::sqrt(std::abs(cross.axes_mm.determinant()));
  MarkWord word;
  for (int slot = 0; slot < kMarkSlots; ++slot) {
    const Vector2d p_T_mm = cross.p_T_mm + cross.axes_mm * slotCentre(slot);
    const auto light = lightAt(p_T_mm, kLook * half_mm, tiles, calibration, open_gray);
    if (!light) return "is not whole in any picture";
    if (*light > kBoardLight && *light < kTickLight) return "has a tick that is neither there nor not";
    if (*light >= kTickLight) word.set(static_cast<std::size_t>(slot));
  }
  if (const auto reading = readWord(word)) return *reading;
  if (word.count() != static_cast<std::size_t>(kMarkTicks))
    return "has " + std::to_string(word.count()) + " ticks; " + std::to_string(kMarkTicks) + " make a number";
  return "has ticks that make no number";
}

}  // namespace kerfbench::calibrate
