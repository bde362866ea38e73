// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/film.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/base/parallel.h"
#include "hil/scene/fixed_picture.h"

namespace kerfbench::scene {
namespace {

constexpr double kLook_s = 0.02;  // The shortest time between two looks for a cycle.
constexpr std::size_t kLooks = 3000;
/// A gantry that moves by less stands.
constexpr double kLeast_mm = 1.0;
/// Shares of the way on which a turn is on one side or on the other.
constexpr double kLowShare = 0.25, kHighShare = 0.75;
constexpr std::size_t kViews = 9;

struct HeadLook {
  double time_s{}, head_x_mm{};
  bool is_lit{};
};

std::vector<HeadLook> headLooks(const SceneAt& scene_at, double end_s) {
  const auto wanted = static_cast<std::size_t>(std::ceil(end_s / kLook_s));
  const std::size_t looks = std::clamp<std::size_t>(wanted, 100, kLooks);
  std::vector<HeadLook> all;
  for (std::size_t i = 0; i <= looks; ++i) {
    const double time_s = end_s * static_cast<double>(i) / static_cast<double>(looks);
    const twin::Scene scene = scene_at(time_s);
    all.push_back({time_s, scene.head.isEmpty() ? 0.0 : scene.head.center().x(), scene.beam_on});
  }
  return all;
}

/// From the last time that the head is at its lowest, before it has once gone over, to the first such time
/// behind that.
std::optional<FilmSpan> forthAndBack(const std::vector<HeadLook>& looks) {
  const auto ends = std::ranges::minmax(looks, {}, &HeadLook::head_x_mm);
  const double low_mm = ends.min.head_x_mm;
  const double way_mm = ends.max.head_x_mm - low_mm;
  if (!(way_mm > kLeast_mm)) return std::nullopt;
  const auto isLow = [&](const HeadLook& look) { return look.head_x_mm < low_mm + kLowShare * way_mm; };
  const auto isHigh = [&](const HeadLook& look) { return look.head_x_mm > low_mm + kHighShare * way_mm; };
  const auto over = std::ranges::find_if(looks, isHigh);
  const auto back = std::find_if(over, looks.end(), isLow);
  const auto away = std::find_if_not(back, looks.end(), isLow);
  auto first = std::make_reverse_iterator(over);
  for (auto it = first; it != looks.rend(); ++it)
    if (it->head_x_mm < first->head_x_mm) first = it;
  const auto last = back == looks.end() ? std::prev(looks.end())
                                        : std::ranges::min_element(back, away, {}, &HeadLook::head_x_mm);
  return FilmSpan{first == looks.rend() ? 0.0 : first->time_s, last->time_s};
}

}  // namespace

std::size_t FilmSpan::pictures() const {
  const double film_s = std::max(0.0, to_s - from_s) * slow;
  return 1 + static_cast<std::size_t>(std::floor(film_s * pictures_each_s + 1e-9));
}

double FilmSpan::timeOf_s(std::size_t picture) const {
  return std::min(to_s, from_s + static_cast<double>(picture) / (slow * pictures_each_s));
}

FilmSpan cycleOf(const SceneAt& scene_at, double end_s, double period_s) {
  const std::vector<HeadLook> looks = headLooks(scene_at, end_s);
  if (const auto span = forthAndBack(looks)) return *span;
  const auto first = std::ranges::find_if(looks, &HeadLook::is_lit);
  if (first == looks.end()) return {0.0, end_s};
  const auto last =
      std::find_if(looks.rbegin(), looks.rend(), [](const HeadLook& look) { return look.is_lit; });
  const double to_s = period_s > 0.0 ? std::min(first->time_s + period_s, end_s) : last->time_s;
  return {first->time_s, to_s};
}

void makeFilm(const SceneAt& scene_at, const FilmSpan& span, const PictureOptions& picture, int threads,
              FilmWriter& film, const std::function<void(std::size_t done)>& told) {
  PictureOptions drawn = picture;
  drawn.quality = PictureQuality::kDrawn;
  // All that the machine's parts reach in the film.
  twin::Scene all = scene_at(span.from_s);
  for (std::size_t i = 1; i < kViews; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kViews - 1);
    const twin::Scene later = scene_at(span.from_s + share * (span.to_s - span.from_s));
    all.parts.insert(all.parts.end(), later.parts.begin(), later.parts.end());
  }
  const Viewpoint view = viewpointOf(all, drawn.view, drawn.width_px, drawn.height_px, hasInset(all, drawn));
  const bool stands = drawn.view == SceneView::kOverall;
  const std::size_t pictures = span.pictures();
  const auto together = static_cast<std::size_t>(std::max(1, threads));
  for (std::size_t first = 0; first < pictures; first += together) {
    std::vector<std::vector<std::uint8_t>> pngs(std::min(together, pictures - first));
    base::forEachIndex(pngs.size(), threads, [&](std::size_t i) {
      const twin::Scene scene = scene_at(span.timeOf_s(first + i));
      pngs[i] = stands ? renderPngFrom(scene, drawn, view) : renderPng(scene, drawn);
    });
    for (const std::vector<std::uint8_t>& png : pngs) film.add(png);
    if (told) told(first + pngs.size());
  }
}

}  // namespace kerfbench::scene
