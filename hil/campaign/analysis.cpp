// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/analysis.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/number_from.h"
#include "twin/base/statistics.h"

namespace kerfbench::campaign {
namespace {

constexpr const char* kScenario = "scenario";
/// A factor of more values than this, all of them numbers, is told by ranges.
constexpr std::size_t kMostValuesTold = 12;
constexpr std::size_t kRanges = 6;

RateRow rowOf(const std::string& value, const std::vector<const Record*>& records) {
  RateRow row{.value = value, .outcomes = {}, .pass_rate = std::nullopt};
  for (const Record* record : records) row.outcomes.add(record->outcome);
  if (row.outcomes.judged() > 0)
    row.pass_rate = base::clopperPearson(row.outcomes.pass, row.outcomes.judged());
  return row;
}

/// Numbers in their order, then words in theirs.
struct ByNumber {
  bool operator()(const std::string& a, const std::string& b) const {
    const auto na = base::numberFrom<double>(a), nb = base::numberFrom<double>(b);
    if (na && nb && *na != *nb) return *na < *nb;
    if (na.has_value() != nb.has_value()) return na.has_value();
    return a < b;
  }
};
using ByValue = std::map<std::string, std::vector<const Record*>, ByNumber>;

/// Ranges with equal numbers of runs in them, of values that are all numbers.
std::vector<RateRow> byRanges(const ByValue& by_value, std::size_t runs) {
  std::vector<RateRow> rows;
  std::vector<const Record*> in_range;
  std::string first, last;
  std::size_t told = 0;
  for (const auto& [value, records] : by_value) {
    if (in_range.empty()) first = value;
    last = value;
    in_range.insert(in_range.end(), records.begin(), records.end());
    const std::size_t wanted = runs * (rows.size() + 1) / kRanges;
    if (told + in_range.size() < wanted) continue;
    told += in_range.size();
    rows.push_back(rowOf(first == last ? first : fmt::format("{} … {}", first, last), in_range));
    in_range.clear();
  }
  return rows;
}

FactorRates ratesOf(const std::string& factor, const std::vector<Record>& records,
                    const std::function<std::string(const Record&)>& valueIn) {
  ByValue by_value;
  for (const Record& record : records) by_value[valueIn(record)].push_back(&record);
  FactorRates rates{factor, {}};
  const bool numbers = std::ranges::all_of(
      by_value, [](const auto& entry) { return base::numberFrom<double>(entry.first).has_value(); });
  if (numbers && by_value.size() > kMostValuesTold) {
    rates.rows = byRanges(by_value, records.size());
    return rates;
  }
  for (const auto& [value, those] : by_value) rates.rows.push_back(rowOf(value, those));
  return rates;
}

std::vector<FactorRates> allRates(const std::vector<Record>& records) {
  std::vector<FactorRates> rates;
  if (records.empty()) return rates;
  const std::string& base = records.front().base;
  if (std::ranges::any_of(records, [&](const Record& r) { return r.base != base; }))
    rates.push_back(ratesOf(kScenario, records, [](const Record& r) { return r.base; }));
  for (std::size_t i = 0; i < records.front().factors.size(); ++i)
    rates.push_back(ratesOf(records.front().factors[i].factor, records,
                            [i](const Record& r) { return r.factors.at(i).value; }));
  return rates;
}

std::vector<FaultDetection> allDetections(const std::vector<Record>& records) {
  std::map<std::tuple<std::string, std::string, std::string>, FaultDetection> found;
  for (const Record& record : records) {
    if (record.outcome == kRefused || record.outcome == kBroken) continue;
    for (const FactorValue& factor : record.factors) {
      if (!factor.size) continue;
      FaultDetection& d = found[{record.base, factor.factor, factor.value}];
      d.base = record.base;
      d.factor = factor.factor;
      d.fault = factor.value;
      d.fails.push_back({*factor.size, record.outcome == "FAIL"});
      d.no_passes.push_back({*factor.size, record.outcome != "PASS"});
    }
  }
  std::vector<FaultDetection> detections;
  for (auto& [key, d] : found) {
    d.by_fail = detectionOf(d.fails);
    d.by_no_pass = detectionOf(d.no_passes);
    detections.push_back(std::move(d));
  }
  return detections;
}

bool isGood(const Record& record) {
  return record.outcome != kRefused && record.outcome != kBroken &&
         std::ranges::none_of(record.factors, [](const FactorValue& f) { return f.size.has_value(); });
}

std::vector<CheckMargin> allMargins(const std::vector<Record>& records, bool of_good) {
  std::map<std::string, CheckMargin> margins;
  for (const Record& record : records) {
    if (of_good ? !isGood(record) : record.outcome != "PASS") continue;
    for (const CheckRecord& check : record.checks) {
      const std::optional<double> margin = marginOf(check);
      if (!margin) continue;
      CheckMargin& m = margins[check.name];
      if (m.runs++ == 0 || *margin < m.least) {
        m.least = *margin;
        m.thinnest = check;
        m.thinnest_run = record.run;
      }
      m.margins.push_back(*margin);
      m.at.push_back(record.run);
    }
  }
  std::vector<CheckMargin> list;
  for (auto& [name, m] : margins) {
    m.check = name;
    m.unit = m.thinnest.unit;
    m.median = medianOf(m.margins);
    list.push_back(std::move(m));
  }
  std::ranges::stable_sort(list,
                           [](const CheckMargin& a, const CheckMargin& b) { return a.least < b.least; });
  return list;
}

std::vector<CheckCount> allCounts(const std::vector<Record>& records) {
  std::map<std::string, CheckCount> counts;
  for (const Record& record : records) {
    for (const CheckRecord& check : record.checks) {
      CheckCount& c = counts[check.name];
      c.check = check.name;
      c.fail += check.verdict == "FAIL" ? 1 : 0;
      c.not_proven += check.verdict == "NOT PROVEN" ? 1 : 0;
      c.invalid += check.verdict == "INVALID" ? 1 : 0;
    }
  }
  std::vector<CheckCount> list;
  for (const auto& [name, c] : counts)
    if (c.fail + c.not_proven + c.invalid > 0) list.push_back(c);
  std::ranges::stable_sort(list, [](const CheckCount& a, const CheckCount& b) {
    return std::tie(a.fail, a.not_proven, a.invalid) > std::tie(b.fail, b.not_proven, b.invalid);
  });
  return list;
}

}  // namespace

void Outcomes::add(const std::string& outcome) {
  if (outcome == "PASS") {
    ++pass;
  } else if (outcome == "FAIL") {
    ++fail;
  } else if (outcome == "NOT PROVEN") {
    ++not_proven;
  } else if (outcome == kRefused) {
    ++refused;
  } else if (outcome == kBroken) {
    ++broken;
  } else {
    ++invalid;
  }
}

std::optional<double> marginOf(const CheckRecord& check) {
  if (!check.value || !check.limit || *check.limit == 0.0) return std::nullopt;
  const double left =
      check.lower ? *check.value - check.u - *check.limit : *check.limit - *check.value - check.u;
  return left / std::abs(*check.limit);
}

Analysis analyse(const std::vector<Record>& records) {
  Analysis analysis;
  for (const Record& record : records) analysis.outcomes.add(record.outcome);
  analysis.runs = records.size();
  analysis.rates = allRates(records);
  analysis.detections = allDetections(records);
  analysis.margins_of_good = std::ranges::any_of(records, isGood);
  analysis.margins = allMargins(records, analysis.margins_of_good);
  analysis.counts = allCounts(records);
  return analysis;
}

void writeAnalysis(const Analysis& analysis, const std::vector<Record>& records,
                   const std::filesystem::path& folder) {
  base::writeFileAtomically(folder / "analysis.json", analysisJson(analysis));
  base::writeFileAtomically(folder / "campaign.html", analysisPage(analysis, records));
}

}  // namespace kerfbench::campaign
