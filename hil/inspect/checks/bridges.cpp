// SPDX-License-Identifier: Apache-2.0
// Does a piece come off? Bridges that are each short enough hold it together when they are many.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/whereabouts.h"

namespace kerfbench::inspect::checks {
namespace {

/// A station lacks light beyond that share of what is usual around it. Good cuts of the scenarios in fixtures
/// lack 0.026 at most; a bridge of 0.05 mm takes 0.25 from a caliper that averages over 0.2 mm.
constexpr double kLacking = 0.08;
/// Reach of "around": so far from a station on either side.
constexpr double kAround_mm = 2.5;
/// Share of the stations around that may lie in bridges; the others tell what is usual.
constexpr double kMostBridged = 0.75;
/// Stations beyond a bridge whose calipers reach into it.
constexpr std::ptrdiff_t kBeside = 2;
/// Standard error of a sum of bridges, as a share: by what is usual, and by board that shines through.
constexpr double kShareOfSum = 0.05;

/// Uncut pieces of a line, or of lines that hang together.
struct Bridges {
  double length_mm{};   ///< Length of the lines.
  double sum_mm{};      ///< All pieces together.
  double longest_mm{};  ///< The longest of them.
  std::size_t count{};
  double pitch_mm{};  ///< Distance of stations.

  void add(const Bridges& other) {
    length_mm += other.length_mm;
    sum_mm += other.sum_mm;
    longest_mm = std::max(longest_mm, other.longest_mm);
    count += other.count;
    pitch_mm = std::max(pitch_mm, other.pitch_mm);
  }
  /// One piece alone is the business of coverage.
  [[nodiscard]] double share() const { return (sum_mm - longest_mm) / length_mm; }
  /// Where between two stations a piece begins and ends is known to a quarter of their distance each.
  [[nodiscard]] double shareU() const {
    const double each_mm = 0.5 * pitch_mm * std::sqrt(static_cast<double>(count));
    return std::hypot(each_mm, 2.0 * kShareOfSum * sum_mm) / length_mm;
  }
};

using Stations = std::vector<const vision::Caliper*>;

/// Light of a whole cut around a station.
double usualAt(const Stations& stations, std::size_t at) {
  const double here_mm = stations[at]->station_mm;
  std::vector<double> light;
  const auto from =
      std::ranges::lower_bound(stations, here_mm - kAround_mm, {}, &vision::Caliper::station_mm);
  for (auto c = from; c != stations.end() && (*c)->station_mm <= here_mm + kAround_mm; ++c)
    light.push_back((*c)->brightness);
  const auto rank = static_cast<std::ptrdiff_t>(kMostBridged * static_cast<double>(light.size() - 1));
  std::ranges::nth_element(light, light.begin() + rank);
  return light[static_cast<std::size_t>(rank)];
}

/// Share of the usual light that each station lacks; < 0 where it has more.
std::vector<double> lackingOf(const Stations& stations) {
  std::vector<double> lacking;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const double usual = std::max(usualAt(stations, i), kBurntBrightness);
    lacking.push_back(1.0 - stations[i]->brightness / usual);
  }
  return lacking;
}

/// Half of the way to the stations before and after.
double pieceOf(const Stations& stations, std::size_t i) {
  const std::size_t before = i == 0 ? i : i - 1;
  const std::size_t after = i + 1 == stations.size() ? i : i + 1;
  const double span_mm = stations[after]->station_mm - stations[before]->station_mm;
  return span_mm / (before == i || after == i ? 1.0 : 2.0);
}

Bridges bridgesOf(const vision::EntityKerf& kerf, const dieline::Curve& curve, const Tolerances& limits) {
  Bridges out{.length_mm = dieline::lengthOf(curve), .pitch_mm = pitchOf(kerf)};
  Stations stations = innerStations(kerf, curve, limits.end_gap_mm);
  // There the light of other kerfs takes part.
  std::erase_if(stations, [](const vision::Caliper* c) { return c->near_joint; });
  const std::vector<double> lacking = lackingOf(stations);
  const auto last = std::ssize(stations) - 1;
  std::ptrdiff_t begin = 0;
  while (begin <= last) {
    if (!(lacking[static_cast<std::size_t>(begin)] > kLacking)) {
      ++begin;
      continue;
    }
    // Two bridges so near that their stations meet are one: the sum is the same.
    std::ptrdiff_t end = begin;
    for (std::ptrdiff_t i = begin; i <= std::min(last, end + 2 * kBeside); ++i)
      if (lacking[static_cast<std::size_t>(i)] > kLacking) end = i;
    double piece_mm = 0.0;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, begin - kBeside); i <= std::min(last, end + kBeside);
         ++i)
      piece_mm += lacking[static_cast<std::size_t>(i)] * pieceOf(stations, static_cast<std::size_t>(i));
    piece_mm = std::max(piece_mm, 0.0);
    out.sum_mm += piece_mm;
    out.longest_mm = std::max(out.longest_mm, piece_mm);
    ++out.count;
    begin = end + 1;
  }
  return out;
}

/// Cuts of a dieline by the outline they belong to: those whose ends meet have one number.
std::map<int, int> outlinesOf(const dieline::Dieline& dieline) {
  std::map<int, int> outline;
  std::vector<const dieline::Entity*> cuts;
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.process != dieline::Process::kCut) continue;
    cuts.push_back(&entity);
    outline[entity.id] = entity.id;
  }
  const auto meet = [](const dieline::Entity& a, const dieline::Entity& b) {
    return std::ranges::any_of(std::array{0.0, 1.0}, [&](double u) {
      return std::ranges::any_of(std::array{0.0, 1.0}, [&](double v) {
        return (dieline::pointAt(a.curve, u) - dieline::pointAt(b.curve, v)).norm() <= kMeet_mm;
      });
    });
  };
  for (std::size_t a = 0; a < cuts.size(); ++a) {
    for (std::size_t b = a + 1; b < cuts.size(); ++b) {
      const int from = outline[cuts[b]->id];
      const int to = outline[cuts[a]->id];
      if (from == to || !meet(*cuts[a], *cuts[b])) continue;
      for (auto& [id, number] : outline)
        if (number == from) number = to;
    }
  }
  return outline;
}

struct Worst {
  Bridges bridges;
  std::string subject;
  Whereabouts where;
  std::size_t lines{1};
};

}  // namespace

Finding bridgesCheck(const Evidence& evidence, const Tolerances& limits) {
  Check check{.name = "bridges", .title = "What was cut comes off", .unit = "share"};
  check.limit = limits.uncut_share;
  const std::map<int, int> outlines = outlinesOf(*evidence.dieline);
  std::vector<Worst> all;
  std::map<std::pair<int, int>, Worst> together;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    const auto outline = outlines.find(kerf.entity);
    if (outline == outlines.end() || kerf.calipers.empty()) continue;
    const Bridges own = bridgesOf(kerf, entityOf(evidence, kerf.entity).curve, limits);
    const std::string name = nameOf(kerf.unit, kerf.entity);
    const Whereabouts where = onLine(kerf.unit, kerf.entity);
    all.push_back({own, name, where});
    const auto [group, is_new] = together.try_emplace({kerf.unit, outline->second}, Worst{own, name, where});
    if (is_new) continue;
    group->second.bridges.add(own);
    ++group->second.lines;
  }
  if (all.empty()) return notApplicable(check, "Nothing of the dieline is to be cut through.");
  for (const auto& [key, group] : together) all.push_back(group);
  const Worst& worst = *std::ranges::max_element(all, {}, [](const Worst& w) { return w.bridges.share(); });
  const Bridges& bridges = worst.bridges;
  check.value = bridges.share();
  if (check.value > 0.0) check.u = check.guard = bridges.shareU();
  check.subject = worst.subject;
  check.where = worst.where;
  decide(check);
  if (bridges.count < 2) {
    check.explanation = fmt::format("None of {} cuts has more than one uncut piece.", outlines.size());
    return check;
  }
  check.explanation = fmt::format(
      "{} has {} uncut pieces, together {:.2f} mm of {:.2f} mm; the longest of them, {:.2f} mm, is left to "
      "coverage.",
      worst.lines == 1 ? check.subject
                       : fmt::format("The outline of {} lines with {}", worst.lines, check.subject),
      bridges.count, bridges.sum_mm, bridges.length_mm, bridges.longest_mm);
  return check;
}

}  // namespace kerfbench::inspect::checks
