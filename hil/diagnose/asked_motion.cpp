// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/asked_motion.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/diagnose/drawing.h"
#include "twin/base/statistics.h"

namespace kerfbench::diagnose {
namespace {

/// Speeds as shares of the usual one, which so large a share of the spans does not exceed.
constexpr double kUsual = 0.9;
constexpr double kFast = 0.8;
constexpr double kSlowest = 0.1;
constexpr double kSlow = 0.5;
/// Light in slow spans, as a share of that in fast ones, from which on power does not follow the speed.
constexpr double kKept = 0.85;
constexpr std::size_t kFewestSpans = 5;

struct Pace {
  double speed_mm_s{};
  double light_share{};
};

/// Speed over the sheet and light of each span but the last of its cut, behind which nothing is known.
std::vector<Pace> pacesOf(const std::vector<AskedCut>& cuts) {
  std::vector<Pace> paces;
  for (const AskedCut& cut : cuts) {
    for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
      Eigen::Vector2d way_mm = cut[i + 1].p_W_mm - cut[i].p_W_mm;
      way_mm.x() -= cut[i + 1].sheet_x_mm - cut[i].sheet_x_mm;
      paces.push_back({way_mm.norm() / kSpan_s, cut[i].light_share});
    }
  }
  return paces;
}

/// Medians of those whose speed lies within these bounds; nullopt of fewer than kFewestSpans.
std::optional<Pace> typical(const std::vector<Pace>& paces, double from_mm_s, double to_mm_s) {
  std::vector<double> speeds;
  std::vector<double> lights;
  for (const Pace& pace : paces) {
    if (pace.speed_mm_s < from_mm_s || pace.speed_mm_s > to_mm_s) continue;
    speeds.push_back(pace.speed_mm_s);
    lights.push_back(pace.light_share);
  }
  if (speeds.size() < kFewestSpans) return std::nullopt;
  return Pace{medianOf(std::move(speeds)), medianOf(std::move(lights))};
}

}  // namespace

std::optional<SteadyPower> steadyPower(const std::vector<AskedCut>& cuts) {
  const std::vector<Pace> paces = pacesOf(cuts);
  if (paces.size() < 2 * kFewestSpans) return std::nullopt;
  std::vector<double> speeds;
  for (const Pace& pace : paces) speeds.push_back(pace.speed_mm_s);
  const auto usual =
      speeds.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(speeds.size() - 1));
  std::ranges::nth_element(speeds, usual);
  const auto fast = typical(paces, kFast * *usual, std::numeric_limits<double>::infinity());
  const auto slow = typical(paces, kSlowest * *usual, kSlow * *usual);
  if (!fast || !slow || !(fast->light_share > 0.0)) return std::nullopt;
  const SteadyPower power{slow->speed_mm_s / fast->speed_mm_s, slow->light_share / fast->light_share};
  return power.light_share >= kKept ? std::optional(power) : std::nullopt;
}

std::string sentenceOf(const SteadyPower& power) {
  return fmt::format(
      "The laser keeps its power where the beam is slow: at {:.0f} % of the full speed it shines for {:.0f} "
      "% of the "
      "time that it shines at full speed. Let power follow speed (Grbl: M4 in place of M3, with $32=1).",
      100.0 * power.slow_share, 100.0 * power.light_share);
}

std::optional<AskedMotion> askedMotion(const std::vector<AskedCut>& cuts, const dieline::Dieline& dieline,
                                       const PrintLayout& print) {
  const Drawing drawing(dieline, print);
  std::optional<AskedMotion> asked;
  for (const AskedCut& cut : cuts) {
    for (std::size_t i = 0; i < cut.size(); ++i) {
      if (cut.size() < 3 || drawing.empty()) continue;
      if (!asked) asked.emplace();
      const Eigen::Vector2d p_mm(cut[i].p_W_mm.x() - cut[i].sheet_x_mm, cut[i].p_W_mm.y());
      asked->off_mm = std::max(asked->off_mm, drawing.awayFrom(drawing.inUnit(p_mm)).norm());
      if (i < 2) continue;
      const Eigen::Vector2d change_mm = cut[i].p_W_mm - 2.0 * cut[i - 1].p_W_mm + cut[i - 2].p_W_mm;
      asked->acceleration_mm_s2 =
          asked->acceleration_mm_s2.cwiseMax(change_mm.cwiseAbs() / (kSpan_s * kSpan_s));
    }
  }
  return asked;
}

}  // namespace kerfbench::diagnose
