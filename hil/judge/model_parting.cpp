// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/model_parting.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerfbench::judge {
namespace {

using Eigen::Vector2d;

/// Place of the model's spot, at the middle of an exposure.
struct ModelSpot {
  double mid_s{};
  Vector2d p_W_mm{Vector2d::Zero()};
};

/// Centre of the light; nothing of a dark one. `length_s` of an exposure.
std::vector<ModelSpot> spotsOf(std::span<const twin::Exposure> exposures, double length_s) {
  std::vector<ModelSpot> spots;
  for (const twin::Exposure& exposure : exposures) {
    Vector2d sum = Vector2d::Zero();
    double light = 0.0;
    for (const twin::ExposureSample& sample : exposure.samples) {
      sum += sample.power_w * sample.p_WQ_mm;
      light += sample.power_w;
    }
    if (light > 0.0) spots.push_back({exposure.start_s + 0.5 * length_s, sum / light});
  }
  return spots;
}

/// Between two neighbours; nothing in a gap of the light.
std::optional<Vector2d> modelAt(const std::vector<ModelSpot>& spots, double time_s) {
  constexpr double kLongest_s = 2.5e-3;
  const auto after = std::ranges::lower_bound(spots, time_s, {}, &ModelSpot::mid_s);
  if (after == spots.begin() || after == spots.end()) return std::nullopt;
  const ModelSpot& before = *(after - 1);
  const double apart_s = after->mid_s - before.mid_s;
  if (apart_s > kLongest_s) return std::nullopt;
  const double share = (time_s - before.mid_s) / apart_s;
  return (1.0 - share) * before.p_W_mm + share * after->p_W_mm;
}

void add(const vision::FrameMeasurement& frame, const Vector2d& off_mm, report::SpotParting& parting) {
  parting.time_s.push_back(frame.mid_s);
  parting.x_mm.push_back(off_mm.x());
  parting.y_mm.push_back(off_mm.y());
  if (off_mm.norm() <= parting.worst_mm) return;
  parting.worst_mm = off_mm.norm();
  parting.worst_s = frame.mid_s;
}

double meanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

std::vector<report::SpotParting> spotPartings(const vision::SpotTrack& track,
                                              std::span<const twin::Exposure> exposures,
                                              const std::vector<inspect::CutResult>& cuts) {
  std::vector<report::SpotParting> partings;
  if (exposures.empty()) return partings;
  constexpr double kStep_s = 10e-6;  // Step of the model's machine, a sample each.
  const std::vector<ModelSpot> spots =
      spotsOf(exposures, kStep_s * static_cast<double>(exposures.front().samples.size()));
  for (const inspect::CutResult& cut : cuts) {
    report::SpotParting parting{.unit = cut.unit, .entity = cut.entity};
    for (const vision::FrameMeasurement& frame : track.frames) {
      if (!frame.spot_W_mm || frame.mid_s < cut.start_s || frame.mid_s > cut.end_s) continue;
      if (const auto model = modelAt(spots, frame.mid_s)) add(frame, *frame.spot_W_mm - *model, parting);
    }
    if (parting.time_s.empty()) continue;
    parting.mean_x_mm = meanOf(parting.x_mm);
    parting.mean_y_mm = meanOf(parting.y_mm);
    partings.push_back(std::move(parting));
  }
  return partings;
}

}  // namespace kerfbench::judge
