// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_model.h"

#include <algorithm>

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr int kSamples = CornerRaster::kSamples;
constexpr int kMarginPx = CornerRaster::kMarginPx;

LightTable tableOf(const CornerLight& light) {
  return {LightLaw(light.board_gray / light.open_gray, light.growth), light.open_gray};
}

/// Samples from which the pixels that count are blurred.
std::vector<bool> neededSamples(const CornerRaster& raster, const PixelGrid& grid,
                                const std::vector<bool>& counts) {
  std::vector<bool> needed(raster.size(), false);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      if (!counts[static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.columns) +
                  static_cast<std::size_t>(c)])
        continue;
      for (int y = kSamples * r; y < kSamples * (r + 1 + 2 * kMarginPx); ++y) {
        for (int x = kSamples * c; x < kSamples * (c + 1 + 2 * kMarginPx); ++x)
          needed[raster.indexOf(x, y)] = true;
      }
    }
  }
  return needed;
}

}  // namespace

CornerModel::CornerModel(const PixelGrid& grid, const std::vector<bool>& counts, const CornerShape& legs)
    : raster_(grid.columns, grid.rows), fluence_(legs), samples_(raster_.size(), 0.0F) {
  const std::vector<bool> needed = neededSamples(raster_, grid, counts);
  const auto placeOf = [](int sample) { return (sample + 0.5) / kSamples - kMarginPx - 0.5; };
  for (int y = 0; y < raster_.rows(); ++y) {
    for (int x = 0; x < raster_.columns(); ++x) {
      if (!needed[raster_.indexOf(x, y)]) continue;
      index_.push_back(raster_.indexOf(x, y));
      fluence_.addPlace(grid.at(placeOf(x), placeOf(y)));
    }
  }
}

void CornerModel::shine(const LightTable& light) {
  for (std::size_t i = 0; i < index_.size(); ++i) samples_[index_[i]] = light.at(share_[i]);
}

void CornerModel::render(const CornerShape& shape, const CornerLight& light, std::vector<float>& gray) {
  fluence_.compute(CornerBeam(shape, light), share_);
  shine(tableOf(light));
  raster_.average(samples_, light.blur_px, gray);
}

void CornerModel::linearizeAt(const CornerShape& shape, const CornerLight& light, std::vector<float>& gray) {
  at_.beam = CornerBeam(shape, light);
  at_.light = tableOf(light);
  at_.blur_px = light.blur_px;
  fluence_.linearizeAt(at_.beam, share_);
  shine(at_.light);
  raster_.average(samples_, light.blur_px, gray);
  at_.samples = samples_;
  at_.gray = gray;
  at_.gray_per_share.resize(index_.size());
  for (std::size_t i = 0; i < index_.size(); ++i) at_.gray_per_share[i] = at_.light.slopeAt(share_[i]);
}

void CornerModel::rateTowards(const CornerShape& shape, const CornerLight& light, double step,
                              std::vector<float>& gray_rate) {
  if (light.blur_px != at_.blur_px) {
    raster_.average(at_.samples, light.blur_px, gray_rate);
    for (std::size_t i = 0; i < gray_rate.size(); ++i)
      gray_rate[i] = (gray_rate[i] - at_.gray[i]) / static_cast<float>(step);
    return;
  }
  const LightTable table = tableOf(light);
  if (table == at_.light) {
    fluence_.rateTowards(CornerBeam(shape, light), step, share_rate_);
    for (std::size_t i = 0; i < index_.size(); ++i)
      samples_[index_[i]] = at_.gray_per_share[i] * share_rate_[i];
  } else {
    shine(at_.light.rateTowards(table, step));
  }
  raster_.average(samples_, at_.blur_px, gray_rate);
}

}  // namespace kerfbench::vision
