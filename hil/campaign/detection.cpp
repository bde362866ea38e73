// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/detection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

namespace kerfbench::campaign {
namespace {

/// Half the 95 % quantile of chi-squared with one degree of freedom.
constexpr double kHalfChiSquared = 0.5 * 3.841458820694124;
constexpr double kMost = 0.9;
constexpr int kNewtonSteps = 200;
constexpr int kBisections = 100;
/// A bound of an interval is looked for as far as so many times the spread of the sizes.
constexpr double kFarthest = 1e4;

/// ln(1 + exp(t)) without overflow.
double softPlus(double t) { return t > 0.0 ? t + std::log1p(std::exp(-t)) : std::log1p(std::exp(t)); }
double logistic(double t) {
  return t >= 0.0 ? 1.0 / (1.0 + std::exp(-t)) : std::exp(t) / (1.0 + std::exp(t));
}

/// Trials at one place: x in units of the spread about the middle.
struct Place {
  double x{};
  double trials{}, found{};
};

/// Log likelihood of logits a + b x, its gradient and the matrix of second derivatives with the sign changed.
struct Likelihood {
  double value{}, ga{}, gb{}, haa{}, hab{}, hbb{};
};

Likelihood likelihoodOf(const std::vector<Place>& places, double a, double b) {
  Likelihood l;
  for (const Place& p : places) {
    const double t = a + b * p.x, chance = logistic(t);
    l.value += p.found * t - p.trials * softPlus(t);
    const double rest = p.found - p.trials * chance, weight = p.trials * chance * (1.0 - chance);
    l.ga += rest;
    l.gb += rest * p.x;
    l.haa += weight;
    l.hab += weight * p.x;
    l.hbb += weight * p.x * p.x;
  }
  return l;
}

/// Follows Newton's steps for the line a + b x; a step that lowers the likelihood is halved.
std::pair<double, double> bestLine(const std::vector<Place>& places) {
  double a = 0.0, b = 0.0;
  Likelihood at = likelihoodOf(places, a, b);
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double det = at.haa * at.hbb - at.hab * at.hab;
    if (!(det > 0.0)) break;
    const double da = (at.hbb * at.ga - at.hab * at.gb) / det, db = (at.haa * at.gb - at.hab * at.ga) / det;
    double share = 1.0;
    Likelihood next = likelihoodOf(places, a + da, b + db);
    while (next.value < at.value && share > 1e-6) {
      share *= 0.5;
      next = likelihoodOf(places, a + share * da, b + share * db);
    }
    a += share * da;
    b += share * db;
    at = next;
    if (std::abs(da) + std::abs(db) < 1e-12) break;
  }
  return {a, b};
}

/// Largest log likelihood of all lines of slope b >= 0 that have the logit `level` at `place`.
double profileAt(const std::vector<Place>& places, double place, double level) {
  double b = 0.0, low = 0.0, high = 1.0;
  const auto slopeOf = [&](double slope) {
    const Likelihood l = likelihoodOf(places, level - slope * place, slope);
    return l.gb - place * l.ga;  // Concave in the slope: the root of the derivative is the maximum.
  };
  while (slopeOf(high) > 0.0 && high < 1e9) high *= 2.0;
  for (int i = 0; i < kBisections; ++i) {
    b = 0.5 * (low + high);
    (slopeOf(b) > 0.0 ? low : high) = b;
  }
  return std::max(likelihoodOf(places, level - b * place, b).value, likelihoodOf(places, level, 0.0).value);
}

/// Where the profile likelihood has fallen by kHalfChiSquared, on one side of the estimate; nothing where it
/// does not.
std::optional<double> boundOf(const std::vector<Place>& places, double estimate, double level, double best,
                              double side) {
  const auto isInside = [&](double x) { return best - profileAt(places, x, level) < kHalfChiSquared; };
  double inside = 0.0, outside = 0.1;
  while (isInside(estimate + side * outside)) {
    inside = outside;
    outside *= 2.0;
    if (outside > kFarthest) return std::nullopt;
  }
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (inside + outside);
    (isInside(estimate + side * middle) ? inside : outside) = middle;
  }
  return estimate + side * outside;
}

/// From the place of a size to the unit in which the fit works, and back.
struct Scale {
  bool logarithmic{};
  double middle{}, spread{1.0};

  [[nodiscard]] double x(double size) const { return logarithmic ? std::log(size) : size; }
  [[nodiscard]] double unit(double size) const { return (x(size) - middle) / spread; }
  [[nodiscard]] double sizeAt(double unit_x) const {
    const double at = middle + spread * unit_x;
    return logarithmic ? std::exp(at) : at;
  }
};

double savedLikelihood(const std::vector<Place>& places) {
  double value = 0.0;
  for (const Place& p : places) {
    if (p.found > 0.0) value += p.found * std::log(p.found / p.trials);
    if (p.found < p.trials) value += (p.trials - p.found) * std::log1p(-p.found / p.trials);
  }
  return value;
}

SizeEstimate estimateOf(const std::vector<Place>& places, const Scale& scale, double a, double b,
                        double chance) {
  const double level = std::log(chance / (1.0 - chance));
  const double best = likelihoodOf(places, a, b).value, place = (level - a) / b;
  SizeEstimate estimate{.size = scale.sizeAt(place), .low = std::nullopt, .high = std::nullopt};
  if (const auto low = boundOf(places, place, level, best, -1.0)) estimate.low = scale.sizeAt(*low);
  if (const auto high = boundOf(places, place, level, best, 1.0)) estimate.high = scale.sizeAt(*high);
  return estimate;
}

std::string whyNotFitted(const Detection& d, const std::map<double, Place>& by_size, double smallest_missed,
                         double largest_found) {
  if (d.trials == 0) return "no run";
  if (d.found == 0) return "none was found";
  if (d.found == d.trials) return "all were found";
  if (by_size.size() < 2) return "all are of one size";
  if (*d.largest_missed <= *d.smallest_found)
    return "one size parts those that were found from those that were missed";
  if (largest_found <= smallest_missed) return "the smaller were found and the larger were missed";
  return {};
}

DetectionFit fitOf(const std::map<double, Place>& by_size, Scale scale, double& slope) {
  std::vector<Place> places;
  double trials = 0.0, squares = 0.0;
  for (const auto& [size, place] : by_size) {
    trials += place.trials;
    scale.middle += place.trials * scale.x(size);
  }
  scale.middle /= trials;
  for (const auto& [size, place] : by_size) {
    const double off = scale.x(size) - scale.middle;
    squares += place.trials * off * off;
  }
  scale.spread = std::sqrt(squares / trials);
  for (const auto& [size, place] : by_size) places.push_back({scale.unit(size), place.trials, place.found});
  const auto [a, b] = bestLine(places);
  slope = b;
  DetectionFit fit;
  if (!(b > 0.0)) return fit;
  fit.slope = b / scale.spread;
  fit.x50 = scale.middle - scale.spread * a / b;
  fit.half = estimateOf(places, scale, a, b, 0.5);
  fit.most = estimateOf(places, scale, a, b, kMost);
  fit.deviance = 2.0 * (savedLikelihood(places) - likelihoodOf(places, a, b).value);
  return fit;
}

}  // namespace

double Detection::chanceAt(double size) const {
  const double x = logarithmic ? std::log(size) : size;
  return logistic(fit->slope * (x - fit->x50));
}

Detection detectionOf(const std::vector<Trial>& trials) {
  Detection d;
  d.trials = trials.size();
  std::map<double, Place> by_size;
  double smallest_missed = 1e300, largest_found = -1e300;
  for (const Trial& t : trials) {
    Place& place = by_size[t.size];
    place.trials += 1.0;
    if (t.found) {
      ++d.found;
      place.found += 1.0;
      d.smallest_found = std::min(d.smallest_found.value_or(t.size), t.size);
      largest_found = std::max(largest_found, t.size);
    } else {
      d.largest_missed = std::max(d.largest_missed.value_or(t.size), t.size);
      smallest_missed = std::min(smallest_missed, t.size);
    }
  }
  if (!by_size.empty()) {
    d.smallest = by_size.begin()->first;
    d.largest = by_size.rbegin()->first;
  }
  d.not_fitted = whyNotFitted(d, by_size, smallest_missed, largest_found);
  d.logarithmic = d.smallest > 0.0 && d.largest >= kLogarithmicFrom * d.smallest;
  if (!d.not_fitted.empty()) return d;
  double slope = 0.0;
  const DetectionFit fit = fitOf(by_size, {.logarithmic = d.logarithmic}, slope);
  if (slope > 0.0) {
    d.fit = fit;
    for (SizeEstimate* estimate : {&d.fit->half, &d.fit->most})
      estimate->is_extrapolated = estimate->size < d.smallest || estimate->size > d.largest;
  } else {
    d.not_fitted = "larger ones were not found more often";
  }
  return d;
}

}  // namespace kerfbench::campaign
