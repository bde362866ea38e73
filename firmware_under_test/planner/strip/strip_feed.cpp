// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/strip/strip_feed.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/number_from.h"
#include "hil/base/text.h"

namespace kerfbench::planner {
namespace {

/// Strip that passes in the first `time_s` after a knot.
double travelAfter(const StripFeed::Knot& knot, double acceleration_mm_s2, double time_s) {
  return time_s * (knot.speed_mm_s + 0.5 * acceleration_mm_s2 * time_s);
}

/// Time after a knot in which this much passes; the speed stays > 0.
double timeAfter(const StripFeed::Knot& knot, double acceleration_mm_s2, double travel_mm) {
  // The root of a t²/2 + v t = s in the form that holds for a = 0 as well.
  const double v = knot.speed_mm_s;
  return 2.0 * travel_mm / (v + std::sqrt(std::max(0.0, v * v + 2.0 * acceleration_mm_s2 * travel_mm)));
}

double accelerationBetween(const StripFeed::Knot& a, const StripFeed::Knot& b) {
  return (b.speed_mm_s - a.speed_mm_s) / (b.time_s - a.time_s);
}

}  // namespace

StripFeed::StripFeed(std::vector<Knot> knots) : knots_(std::move(knots)) {
  std::vector<std::string> faults;
  if (knots_.empty()) faults.emplace_back("the feed has no speed");
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    const Knot& knot = knots_[i];
    if (!(std::isfinite(knot.speed_mm_s) && knot.speed_mm_s > 0.0))
      faults.push_back(
          fmt::format("the feed at {:g} s must be > 0 mm/s, but is {:g}", knot.time_s, knot.speed_mm_s));
    if (!(std::isfinite(knot.time_s) && knot.time_s >= 0.0))
      faults.push_back(fmt::format("times of the feed begin at 0 s, but one is {:g}", knot.time_s));
    if (i > 0 && !(knot.time_s > knots_[i - 1].time_s))
      faults.push_back(fmt::format("times of the feed must rise, but {:g} s follows {:g} s", knot.time_s,
                                   knots_[i - 1].time_s));
  }
  if (!faults.empty()) throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
  if (knots_.front().time_s > 0.0) knots_.insert(knots_.begin(), {0.0, knots_.front().speed_mm_s});
}

StripFeed StripFeed::parse(const std::string& text) {
  std::vector<Knot> knots;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    const std::string_view word = base::trimmed(rest.substr(0, end));
    const std::size_t colon = std::min(word.find(':'), word.size());
    const auto time_s = base::numberFrom<double>(word.substr(0, colon));
    const auto speed_mm_s = base::numberFrom<double>(word.substr(std::min(colon + 1, word.size())));
    if (!time_s || !speed_mm_s)
      throw PlanError(fmt::format("a feed is written as s:mm/s,s:mm/s, not {}", base::inQuotes(word)));
    knots.push_back({*time_s, *speed_mm_s});
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return StripFeed(std::move(knots));
}

double StripFeed::speedMm_s(double time_s) const {
  const auto next = std::ranges::upper_bound(knots_, time_s, {}, &Knot::time_s);
  if (next == knots_.begin()) return knots_.front().speed_mm_s;
  if (next == knots_.end()) return knots_.back().speed_mm_s;
  const Knot& knot = *(next - 1);
  return knot.speed_mm_s + accelerationBetween(knot, *next) * (time_s - knot.time_s);
}

double StripFeed::travelMm(double time_s) const {
  double travel_mm = 0.0;
  for (std::size_t i = 0; i < knots_.size() && knots_[i].time_s < time_s; ++i) {
    const bool last = i + 1 == knots_.size();
    const double to_s = last ? time_s : std::min(time_s, knots_[i + 1].time_s);
    travel_mm += travelAfter(knots_[i], last ? 0.0 : accelerationBetween(knots_[i], knots_[i + 1]),
                             to_s - knots_[i].time_s);
  }
  return travel_mm;
}

double StripFeed::timeS(double travel_mm) const {
  double left_mm = travel_mm;
  for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
    const double acceleration_mm_s2 = accelerationBetween(knots_[i], knots_[i + 1]);
    const double whole_mm =
        travelAfter(knots_[i], acceleration_mm_s2, knots_[i + 1].time_s - knots_[i].time_s);
    if (left_mm <= whole_mm) return knots_[i].time_s + timeAfter(knots_[i], acceleration_mm_s2, left_mm);
    left_mm -= whole_mm;
  }
  return knots_.back().time_s + left_mm / knots_.back().speed_mm_s;
}

double StripFeed::lowestMm_s() const { return std::ranges::min(knots_, {}, &Knot::speed_mm_s).speed_mm_s; }

double StripFeed::highestMm_s() const { return std::ranges::max(knots_, {}, &Knot::speed_mm_s).speed_mm_s; }

}  // namespace kerfbench::planner
