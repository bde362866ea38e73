// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "twin/base/constants.h"

namespace kerfbench::gauge {
Moments momentsOf(const std::vector<double>& values) {
  Moments m{.count = values.size(), .mean = 0.0, .sigma = kNan};
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  if (values.size() < 2) return m;
  double squares = 0.0;
  for (const double v : values) squares += (v - m.mean) * (v - m.mean);
  m.sigma = std::sqrt(squares / (n - 1.0));
  return m;
}

double quantileOf(std::vector<double> values, double p) {
  if (values.empty()) return kNan;
  std::ranges::sort(values);
  const double place = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

std::optional<double> upperToleranceBound(std::vector<double> values, double share, double confidence) {
  std::ranges::sort(values);
  // The r-th smallest lies above the quantile unless r or more values lie below it.
  for (std::size_t r = 1; r <= values.size(); ++r) {
    if (base::binomialCdf(r - 1, values.size(), share) >= confidence) return values[r - 1];
  }
  return std::nullopt;
}

TypeOne typeOne(const std::vector<double>& errors, double tolerance) {
  TypeOne t{.error = momentsOf(errors)};
  t.cg = 0.2 * tolerance / (6.0 * t.error.sigma);
  t.cgk = (0.1 * tolerance - std::abs(t.error.mean)) / (3.0 * t.error.sigma);
  return t;
}

Grr anovaGrr(const std::vector<double>& values, std::size_t parts, std::size_t placements,
             std::size_t repeats, double tolerance) {
  if (parts < 2 || placements < 2 || repeats < 2 || values.size() != parts * placements * repeats)
    throw std::invalid_argument("anovaGrr: two or more of each, and a value for each of them");
  const auto p = static_cast<double>(parts);
  const auto o = static_cast<double>(placements);
  const auto r = static_cast<double>(repeats);
  std::vector<double> part(parts);
  std::vector<double> place(placements);
  std::vector<double> cell(parts * placements);
  double all = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t c = i / repeats;
    cell[c] += values[i] / r;
    part[c / placements] += values[i] / (r * o);
    place[c % placements] += values[i] / (r * p);
    all += values[i] / (r * o * p);
  }
  double ss_part = 0.0;
  double ss_place = 0.0;
  double ss_both = 0.0;
  double ss_repeat = 0.0;
  for (const double m : part) ss_part += o * r * (m - all) * (m - all);
  for (const double m : place) ss_place += p * r * (m - all) * (m - all);
  for (std::size_t c = 0; c < cell.size(); ++c)
    ss_both += r * std::pow(cell[c] - part[c / placements] - place[c % placements] + all, 2);
  for (std::size_t i = 0; i < values.size(); ++i) ss_repeat += std::pow(values[i] - cell[i / repeats], 2);
  const double ms_part = ss_part / (p - 1.0);
  const double ms_place = ss_place / (o - 1.0);
  const double ms_both = ss_both / ((p - 1.0) * (o - 1.0));
  const double ms_repeat = ss_repeat / (p * o * (r - 1.0));
  const double var_both = std::max(0.0, (ms_both - ms_repeat) / r);
  const double var_place = std::max(0.0, (ms_place - ms_both) / (p * r));
  const double var_part = std::max(0.0, (ms_part - ms_both) / (o * r));
  Grr g;
  g.repeatability = std::sqrt(ms_repeat);
  g.reproducibility = std::sqrt(var_place + var_both);
  g.grr = std::hypot(g.repeatability, g.reproducibility);
  g.part = std::sqrt(var_part);
  g.percent_of_tolerance = 100.0 * 6.0 * g.grr / tolerance;
  g.percent_of_study = 100.0 * g.grr / std::hypot(g.grr, g.part);
  g.ndc = 1.41 * g.part / g.grr;
  return g;
}

Linearity linearityOf(const std::vector<double>& truth, const std::vector<double>& error) {
  const Moments x = momentsOf(truth);
  const Moments y = momentsOf(error);
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    xx += (truth[i] - x.mean) * (truth[i] - x.mean);
    xy += (truth[i] - x.mean) * (error[i] - y.mean);
  }
  Linearity l;
  l.slope = xy / xx;
  l.offset = y.mean - l.slope * x.mean;
  double rest = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    rest += std::pow(error[i] - l.offset - l.slope * truth[i], 2);
  l.scatter = std::sqrt(rest / (static_cast<double>(truth.size()) - 2.0));
  l.slope_sigma = l.scatter / std::sqrt(xx);
  return l;
}

}  // namespace kerfbench::gauge
