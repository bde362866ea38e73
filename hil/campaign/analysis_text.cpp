// SPDX-License-Identifier: Apache-2.0
// What a campaign tells, as JSON and as lines for a terminal.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/campaign/analysis.h"
#include "hil/campaign/analysis_words.h"
#include "hil/campaign/merge.h"

namespace kerfbench::campaign {
namespace {

using PageJson = nlohmann::ordered_json;

constexpr int kSchemaVersion = 1;
constexpr std::size_t kMostLines = 5;

PageJson jsonOf(const std::optional<double>& value) { return value ? PageJson(*value) : PageJson(nullptr); }

PageJson jsonOf(const Outcomes& o) {
  return {{"all", o.all()},       {"PASS", o.pass},       {"FAIL", o.fail},    {"NOT PROVEN", o.not_proven},
          {"INVALID", o.invalid}, {"REFUSED", o.refused}, {"BROKEN", o.broken}};
}

PageJson jsonOf(const FactorRates& rates) {
  PageJson rows = PageJson::array();
  for (const RateRow& row : rates.rows) {
    PageJson json{{"value", row.value}, {"runs", jsonOf(row.outcomes)}};
    if (row.pass_rate) {
      json["pass_rate"] = static_cast<double>(row.outcomes.pass) / static_cast<double>(row.outcomes.judged());
      json["pass_rate_95"] = {row.pass_rate->low, row.pass_rate->high};
    } else {
      json["pass_rate"] = nullptr;
      json["pass_rate_95"] = nullptr;
    }
    rows.push_back(std::move(json));
  }
  return {{"factor", rates.factor}, {"values", std::move(rows)}};
}

PageJson jsonOf(const SizeEstimate& e) {
  return {{"size", e.size},
          {"low_95", jsonOf(e.low)},
          {"high_95", jsonOf(e.high)},
          {"extrapolated", e.is_extrapolated}};
}

PageJson jsonOf(const Detection& d) {
  PageJson json{{"runs", d.trials},
                {"smallest_tried", d.smallest},
                {"largest_tried", d.largest},
                {"found", d.found},
                {"largest_missed", jsonOf(d.largest_missed)},
                {"smallest_found", jsonOf(d.smallest_found)},
                {"not_fitted", d.fit ? PageJson(nullptr) : PageJson(d.not_fitted)},
                {"fit", nullptr}};
  if (d.fit)
    json["fit"] = {{"over", d.logarithmic ? "ln(size)" : "size"},
                   {"x50", d.fit->x50},
                   {"slope", d.fit->slope},
                   {"half_found", jsonOf(d.fit->half)},
                   {"nine_of_ten_found", jsonOf(d.fit->most)},
                   {"deviance", d.fit->deviance}};
  return json;
}

PageJson jsonOf(const CheckMargin& m) {
  return {{"check", m.check},
          {"runs", m.runs},
          {"least_margin", m.least},
          {"median_margin", m.median},
          {"thinnest",
           {{"run", m.thinnest_run},
            {"value", jsonOf(m.thinnest.value)},
            {"U", m.thinnest.u},
            {"limit", jsonOf(m.thinnest.limit)},
            {"limit_is", m.thinnest.lower ? "lower" : "upper"},
            {"unit", m.unit}}}};
}

std::string lineOf(const RateRow& row) {
  return row.pass_rate ? fmt::format("{} {}", row.value.empty() ? "-" : row.value, shareWords(row))
                       : fmt::format("{} no verdict", row.value);
}

}  // namespace

std::string shareWords(const RateRow& row) {
  if (!row.pass_rate) return "no verdict";
  return fmt::format("{} of {} ({:.1f} … {:.1f} %)", row.outcomes.pass, row.outcomes.judged(),
                     100.0 * row.pass_rate->low, 100.0 * row.pass_rate->high);
}

std::string sizeWords(const SizeEstimate& e) {
  const auto bound = [](const std::optional<double>& b) {
    return b ? fmt::format("{:.3g}", *b) : std::string("no bound");
  };
  return fmt::format("{:.3g} ({} … {}){}", e.size, bound(e.low), bound(e.high),
                     e.is_extrapolated ? ", beyond the sizes that were tried" : "");
}

std::string detectionWords(const Detection& d) {
  if (d.fit)
    return fmt::format("half of them from {}, nine of ten from {}", sizeWords(d.fit->half),
                       sizeWords(d.fit->most));
  std::string words = fmt::format("not fitted, {}", d.not_fitted);
  if (d.largest_missed) words += fmt::format("; largest missed {:.3g}", *d.largest_missed);
  if (d.smallest_found) words += fmt::format("; smallest found {:.3g}", *d.smallest_found);
  return words;
}

std::string outcomeWords(const Outcomes& o) {
  std::string words =
      fmt::format("{} PASS, {} FAIL, {} NOT PROVEN, {} INVALID", o.pass, o.fail, o.not_proven, o.invalid);
  if (o.refused > 0) words += fmt::format(", {} refused", o.refused);
  if (o.broken > 0) words += fmt::format(", {} broken", o.broken);
  return words;
}

std::string marginWords(const CheckMargin& m) {
  return fmt::format("{:.4g} ± {:.2g} {} {} {:.4g}", m.thinnest.value.value_or(std::nan("")), m.thinnest.u,
                     m.unit, m.thinnest.lower ? ">=" : "<=", m.thinnest.limit.value_or(std::nan("")));
}

std::string analysisJson(const Analysis& a) {
  PageJson json{{"schema_version", kSchemaVersion},
                {"campaign", a.name},
                {"title", a.title},
                {"identity", a.identity},
                {"digest", a.digest},
                {"runs", a.runs},
                {"missing", a.missing},
                {"outcomes", jsonOf(a.outcomes)},
                {"factors", PageJson::array()},
                {"faults", PageJson::array()},
                {"margins_of", a.margins_of_good ? "runs without a fault of a size" : "runs that passed"},
                {"margins", PageJson::array()},
                {"checks_not_passed", PageJson::array()}};
  for (const FactorRates& rates : a.rates) json["factors"].push_back(jsonOf(rates));
  for (const FaultDetection& d : a.detections)
    json["faults"].push_back({{"scenario", d.base},
                              {"factor", d.factor},
                              {"fault", d.fault},
                              {"found_is_fail", jsonOf(d.by_fail)},
                              {"found_is_not_pass", jsonOf(d.by_no_pass)}});
  for (const CheckMargin& m : a.margins) json["margins"].push_back(jsonOf(m));
  for (const CheckCount& c : a.counts)
    json["checks_not_passed"].push_back(
        {{"check", c.check}, {"FAIL", c.fail}, {"NOT PROVEN", c.not_proven}, {"INVALID", c.invalid}});
  return json.dump(2, ' ', false, PageJson::error_handler_t::replace) + "\n";
}

std::vector<std::string> analysisLines(const Analysis& a) {
  std::vector<std::string> lines{fmt::format("{} runs: {}", a.runs, outcomeWords(a.outcomes))};
  if (!a.missing.empty()) lines.push_back(fmt::format("missing: {}", rangesOf(a.missing)));
  for (const FactorRates& rates : a.rates) {
    std::string line = fmt::format("pass rate over {}:", rates.factor);
    for (const RateRow& row : rates.rows) line += (&row == &rates.rows.front() ? " " : "; ") + lineOf(row);
    lines.push_back(std::move(line));
  }
  for (const FaultDetection& d : a.detections)
    lines.push_back(fmt::format("{} in {}: found {} of {}; {}", d.fault, d.base, d.by_fail.found,
                                d.by_fail.trials, detectionWords(d.by_fail)));
  for (std::size_t i = 0; i < std::min(kMostLines, a.margins.size()); ++i)
    lines.push_back(fmt::format("thin margin: {} {:.1f} % in run {}: {}", a.margins[i].check,
                                100.0 * a.margins[i].least, a.margins[i].thinnest_run,
                                marginWords(a.margins[i])));
  return lines;
}

}  // namespace kerfbench::campaign
