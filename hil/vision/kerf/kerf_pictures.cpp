// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_pictures.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/camera/kerf_tile.h"
#include "hil/vision/kerf/kerf_faults.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

constexpr std::size_t kTilesPerBatch = 8;

std::vector<double> diametersOf(const PrintLayout& print) {
  std::vector<double> diameters_mm;
  for (const RegistrationMark& mark : print.marks) diameters_mm.push_back(mark.diameter_mm);
  std::sort(diameters_mm.begin(), diameters_mm.end());
  diameters_mm.erase(std::unique(diameters_mm.begin(), diameters_mm.end()), diameters_mm.end());
  return diameters_mm;
}

}  // namespace

std::vector<camera::KerfTile> UnitTiles::next() {
  std::vector<camera::KerfTile> unit;
  for (;;) {
    if (pending_.empty()) {
      pending_ = source_.nextBatch(kTilesPerBatch);
      if (pending_.empty()) return unit;
      for (const camera::KerfTile& tile : pending_) {
        if (tile.image.width != calibration_.width_px || tile.image.height != calibration_.height_px) {
          throw std::invalid_argument("a kerf tile of unit " + std::to_string(tile.unit) +
                                      " has not the size that the camera is calibrated for");
        }
      }
      std::reverse(pending_.begin(), pending_.end());
    }
    if (!unit.empty() && pending_.back().unit != unit.front().unit) return unit;
    unit.push_back(std::move(pending_.back()));
    pending_.pop_back();
    // Tiles of the next one may not have been taken yet.
    if (unit.back().is_last) return unit;
  }
}

UnitPictures viewUnit(std::vector<camera::KerfTile> tiles, int unit, const PrintLayout& print,
                      const CameraCalibration& calibration, const KerfScanOptions& options,
                      std::vector<std::string>& problems) {
  const std::vector<double> diameters_mm = diametersOf(print);
  UnitPictures pictures;
  pictures.views.resize(tiles.size());
  base::forEachIndex(tiles.size(), options.threads, [&](std::size_t i) {
    pictures.views[i] = viewTile(std::move(tiles[i]), calibration, diameters_mm);
  });
  pictures.blur = blurOf(pictures.views, calibration);
  tellTileFaults(pictures.views, unit, pictures.blur, options.widest_blur_px, problems);
  shareLight(pictures.views);
  return pictures;
}

}  // namespace kerfbench::vision
