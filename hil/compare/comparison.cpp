// SPDX-License-Identifier: Apache-2.0
#include "hil/compare/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_error.h"

namespace kerfbench::compare {
namespace {

using Key = std::tuple<Figure::Of, std::string, std::string>;

/// A figure in the runs of a release, in the order of the runs; nothing where a run lacks it.
struct Series {
  Figure figure;  ///< The first run's that has it.
  std::vector<std::optional<Figure>> of_run;

  [[nodiscard]] std::vector<Figure> there() const {
    std::vector<Figure> found;
    for (const std::optional<Figure>& f : of_run)
      if (f) found.push_back(*f);
    return found;
  }
};

std::map<Key, Series> seriesOf(const RunSet& release) {
  std::map<Key, Series> all;
  for (std::size_t run = 0; run < release.runs.size(); ++run) {
    for (const Figure& figure : release.runs[run].figures) {
      Series& series = all[{figure.of, figure.place, figure.quantity}];
      if (series.of_run.empty()) {
        series.figure = figure;
        series.of_run.resize(release.runs.size());
      }
      series.of_run[run] = figure;
    }
  }
  return all;
}

double meanOf(const std::vector<Figure>& figures) {
  const double sum = std::accumulate(figures.begin(), figures.end(), 0.0,
                                     [](double s, const Figure& f) { return s + f.value; });
  return sum / static_cast<double>(figures.size());
}

/// Standard uncertainty of the mean, as the measurements state it.
double statedOf(const std::vector<Figure>& figures) {
  double sum = 0.0;
  for (const Figure& f : figures) sum += f.sigma * f.sigma;
  return std::sqrt(sum) / static_cast<double>(figures.size());
}

double sumOfSquares(const std::vector<double>& values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  return std::accumulate(values.begin(), values.end(), 0.0,
                         [mean](double s, double v) { return s + (v - mean) * (v - mean); });
}

std::vector<double> valuesOf(const std::vector<Figure>& figures) {
  std::vector<double> values;
  for (const Figure& f : figures) values.push_back(f.value);
  return values;
}

/// The spread of a difference between runs: its standard uncertainty and degrees of freedom.
struct Spread {
  double sigma{};
  double freedom{};  ///< 0: too few runs to tell.
};

/// Runs with the same seed are pairs: what their machines have in common drops out.
Spread spreadOfPairs(const Series& before, const Series& after) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < std::min(before.of_run.size(), after.of_run.size()); ++i) {
    if (before.of_run[i] && after.of_run[i])
      differences.push_back(after.of_run[i]->value - before.of_run[i]->value);
  }
  if (differences.size() < kFewestRunsForSpread) return {};
  const auto n = static_cast<double>(differences.size());
  return {std::sqrt(sumOfSquares(differences) / (n - 1.0) / n), n - 1.0};
}

/// Both releases' machines are samples of the same kind: their spreads are pooled.
Spread spreadOfRuns(const Series& before, const Series& after) {
  double squares = 0.0, freedom = 0.0, per_run = 0.0;
  for (const Series* series : {&before, &after}) {
    const std::vector<double> values = valuesOf(series->there());
    per_run += 1.0 / static_cast<double>(values.size());
    if (values.size() < kFewestRunsForSpread) continue;
    squares += sumOfSquares(values);
    freedom += static_cast<double>(values.size()) - 1.0;
  }
  if (freedom == 0.0) return {};
  return {std::sqrt(squares / freedom * per_run), freedom};
}

/// Quantile of the normal distribution that Student's t stands for: Wallace, Annals of Mathematical
/// Statistics 30 (1959) 1124. Off by less than 0.03 from three degrees of freedom on.
double normalOfStudent(double t, double freedom) {
  const double z = std::sqrt(freedom * std::log1p(t * t / freedom));
  return (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * z;
}

/// z beyond which, on both sides, a normal quantity lies with this chance.
double normalBeyond(double chance) {
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double z = 0.5 * (low + high);
    (std::erfc(z / std::sqrt(2.0)) > chance ? low : high) = z;
  }
  return 0.5 * (low + high);
}

bool awayFromGood(Better better, double before, double after) {
  switch (better) {
    case Better::kSmaller:
      return after > before;
    case Better::kLarger:
      return after < before;
    case Better::kNearZero:
      return std::abs(after) > std::abs(before);
    case Better::kNeither:
      return false;
  }
  return false;
}

bool samplesMachines(const RunSet& release) {
  return std::ranges::any_of(release.runs, [](const RunFigures& r) { return r.imperfections != "ideal"; });
}

/// Seed by seed the same machines.
bool arePaired(const RunSet& before, const RunSet& after) {
  return before.runs.size() == after.runs.size() &&
         std::ranges::equal(before.runs, after.runs, {}, &RunFigures::seed, &RunFigures::seed);
}

class Comparer {
 public:
  Comparer(const RunSet& before, const RunSet& after) : before_(before), after_(after) {
    paired_ = arePaired(before, after);
    spread_needed_ = !paired_ && (samplesMachines(before) || samplesMachines(after));
    result_.told_apart =
        !spread_needed_ || std::max(before.runs.size(), after.runs.size()) >= kFewestRunsForSpread;
  }

  Comparison compare() {
    warn();
    compareFigures();
    judge();
    compareVerdicts();
    return std::move(result_);
  }

 private:
  void warn();
  void compareFigures();
  void addDifference(const Series& before, const Series& after);
  void judge();
  void compareVerdicts();
  [[nodiscard]] const Difference* checkValue(const std::string& check) const;

  const RunSet& before_;
  const RunSet& after_;
  bool paired_{}, spread_needed_{};
  std::map<Key, Better> better_;
  Comparison result_;
};

void Comparer::warn() {
  const RunFigures& before = before_.runs.front();
  const RunFigures& after = after_.runs.front();
  const auto caution = [&](bool differs, std::string text) {
    if (differs) result_.cautions.push_back(std::move(text));
  };
  caution(before.bench_version != after.bench_version,
          fmt::format("measured by other benches: kerfbench {} and {}", before.bench_version,
                      after.bench_version));
  caution(before.imperfections != after.imperfections || before.twin != after.twin,
          fmt::format("other models: imperfections {} on the {} twin, and {} on the {} twin",
                      before.imperfections, before.twin, after.imperfections, after.twin));
  std::string changed;
  for (const auto& [file, sum] : before.inputs) {
    const auto now = after.inputs.find(file);
    const bool is_image = sum == before.firmware_sha256;
    if (!is_image && now != after.inputs.end() && now->second != sum)
      changed += (changed.empty() ? "" : ", ") + file;
  }
  caution(!changed.empty(), "not the release alone is another, these files are too: " + changed);
  caution(!result_.told_apart, fmt::format("the machines are sampled anew by another seed, and {} runs of a "
                                           "release are needed to know how far "
                                           "such machines differ: run both releases with one --seed",
                                           kFewestRunsForSpread));
}

void Comparer::addDifference(const Series& before, const Series& after) {
  const std::vector<Figure> old_runs = before.there(), new_runs = after.there();
  Difference d;
  d.of = before.figure.of;
  d.place = before.figure.place;
  d.quantity = before.figure.quantity;
  d.unit = before.figure.unit;
  d.old_value = meanOf(old_runs);
  d.new_value = meanOf(new_runs);
  d.difference = d.new_value - d.old_value;
  const double stated = std::hypot(statedOf(old_runs), statedOf(new_runs));
  const Spread spread = paired_ ? spreadOfPairs(before, after) : spreadOfRuns(before, after);
  const bool by_spread = spread.freedom > 0.0 && spread.sigma > stated;
  const double sigma = by_spread ? spread.sigma : stated;
  d.u = 2.0 * sigma;
  if (sigma > 0.0) {
    const double ratio = std::abs(d.difference) / sigma;
    d.z = by_spread ? normalOfStudent(ratio, spread.freedom) : ratio;
  }
  better_[{d.of, d.place, d.quantity}] = before.figure.better;
  result_.differences.push_back(std::move(d));
}

void Comparer::compareFigures() {
  const std::map<Key, Series> before = seriesOf(before_), after = seriesOf(after_);
  const auto name = [](const Series& s) { return s.figure.place + ", " + s.figure.quantity; };
  for (const auto& [key, series] : before) {
    const auto found = after.find(key);
    if (found == after.end()) {
      result_.only_old.push_back(name(series));
    } else {
      addDifference(series, found->second);
    }
  }
  for (const auto& [key, series] : after)
    if (!before.contains(key)) result_.only_new.push_back(name(series));
}

void Comparer::judge() {
  const auto measured =
      std::ranges::count_if(result_.differences, [](const Difference& d) { return d.u > 0.0; });
  result_.threshold_z =
      normalBeyond(-std::expm1(std::log1p(-kFalseAlarms) / static_cast<double>(std::max<long>(measured, 1))));
  for (Difference& d : result_.differences) {
    d.significant = result_.told_apart && d.z > result_.threshold_z;
    const Better good = better_.at({d.of, d.place, d.quantity});
    d.worse = d.significant && awayFromGood(good, d.old_value, d.new_value);
    d.better = d.significant && awayFromGood(good, d.new_value, d.old_value);
  }
  std::ranges::stable_sort(result_.differences, std::greater<>(), &Difference::z);
}

const Difference* Comparer::checkValue(const std::string& check) const {
  const auto found = std::ranges::find_if(result_.differences, [&](const Difference& d) {
    return d.of == Figure::Of::kCheck && d.place == check;
  });
  return found == result_.differences.end() ? nullptr : &*found;
}

/// The worst verdict of a check among the runs; nothing where no run judged it.
std::optional<std::string> worstVerdict(const RunSet& release, const std::string& check) {
  std::optional<std::string> worst;
  for (const RunFigures& run : release.runs) {
    const auto found = run.checks.find(check);
    if (found == run.checks.end()) continue;
    if (!worst || verdictRank(found->second.verdict) > verdictRank(*worst)) worst = found->second.verdict;
  }
  return worst;
}

std::string whyNotJudged(const RunSet& release, const std::string& check) {
  for (const RunFigures& run : release.runs) {
    if (const auto found = run.not_judged.find(check); found != run.not_judged.end()) return found->second;
  }
  return {};
}

void Comparer::compareVerdicts() {
  std::set<std::string> names;
  for (const RunSet* release : {&before_, &after_}) {
    for (const RunFigures& run : release->runs) {
      for (const auto& [check, verdict] : run.checks) names.insert(check);
    }
  }
  for (const std::string& check : names) {
    const std::optional<std::string> before = worstVerdict(before_, check),
                                     after = worstVerdict(after_, check);
    if (before == after) continue;
    VerdictChange change{check, before.value_or("not judged"), after.value_or("not judged"),
                         whyNotJudged(after ? before_ : after_, check), false};
    if (!after) {
      // A check that does not apply any more is another job, which the cautions tell.
      change.worse = !change.why.empty();
    } else if (before && verdictRank(*after) > verdictRank(*before)) {
      const Difference* value = checkValue(check);
      const bool counted = value != nullptr && value->u == 0.0 && value->difference != 0.0;
      change.worse = *after == "INVALID" || counted || (value != nullptr && value->significant);
    }
    result_.verdicts.push_back(std::move(change));
  }
}

void refuseMixed(const RunSet& release) {
  for (const RunFigures& run : release.runs) {
    const RunFigures& first = release.runs.front();
    if (run.scenario != first.scenario || run.firmware_sha256 != first.firmware_sha256) {
      throw base::InputError(
          fmt::format("{}: runs of one release on one job are asked for; {} is of '{}' with firmware {}, {} "
                      "of '{}' with {}",
                      release.name, first.folder.string(), first.scenario, first.firmware_sha256.substr(0, 8),
                      run.folder.string(), run.scenario, run.firmware_sha256.substr(0, 8)));
    }
  }
}

}  // namespace

bool Comparison::anythingWorse() const {
  return std::ranges::any_of(differences, &Difference::worse) ||
         std::ranges::any_of(verdicts, &VerdictChange::worse);
}

Comparison compareReleases(const RunSet& old_release, const RunSet& new_release) {
  refuseMixed(old_release);
  refuseMixed(new_release);
  const RunFigures &before = old_release.runs.front(), &after = new_release.runs.front();
  if (before.scenario != after.scenario) {
    throw base::InputError(
        fmt::format("{} is of the scenario '{}', {} of '{}': two runs of one job are compared",
                    before.folder.string(), before.scenario, after.folder.string(), after.scenario));
  }
  return Comparer(old_release, new_release).compare();
}

}  // namespace kerfbench::compare
