// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <nlohmann/json.hpp>

#include "hil/base/digest.h"
#include "hil/suite/suite_report.h"

namespace kerfbench::suite {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson numberOrNull(double value) { return std::isfinite(value) ? OrderedJson(value) : OrderedJson(); }

template <typename Value>
OrderedJson orNull(const std::optional<Value>& value) {
  return value ? OrderedJson(*value) : OrderedJson();
}

OrderedJson checkJson(const inspect::Check& check) {
  return {{"name", check.name},
          {"verdict", inspect::verdictName(check.verdict)},
          {"value", numberOrNull(check.value)},
          {"expanded_uncertainty", numberOrNull(check.u)},
          {"limit", numberOrNull(check.limit)},
          {"limit_is", check.upper ? "upper" : "lower"},
          {"unit", check.unit},
          {"subject", check.subject}};
}

OrderedJson choicesJson(const RunChoices& choices) {
  return {{"seed", orNull(choices.seed)},
          {"imperfections", orNull(choices.imperfections)},
          {"twin", orNull(choices.twin)},
          {"time_limit_s", orNull(choices.time_limit_s)},
          {"limits", choices.limits}};
}

OrderedJson verdictFields(const RunVerdict& verdict) {
  OrderedJson checks = OrderedJson::array();
  for (const inspect::Check& check : verdict.checks) checks.push_back(checkJson(check));
  return {{"verdict", verdict.verdict},
          {"summary", verdict.summary},
          {"likely_cause", verdict.likely_cause},
          {"problems", verdict.problems},
          {"reservations", verdict.reservations},
          {"firmware", verdict.firmware},
          {"firmware_sha256", verdict.firmware_sha256},
          {"seed", verdict.seed},
          {"imperfections", verdict.imperfections},
          {"twin", verdict.twin},
          {"virtual_s", verdict.virtual_s},
          {"checks", checks},
          {"digest", verdict.digest},
          {"inputs_digest", verdict.inputs_digest},
          {"report", ""}};
}

OrderedJson rowJson(const SuiteRow& row) {
  OrderedJson json{{"name", row.run.name},
                   {"scenario", row.run.scenario_as_written},
                   {"title", row.run.title},
                   {"tags", row.run.tags},
                   {"choices", choicesJson(row.run.choices)},
                   {"takes_release", row.run.takes_release},
                   {"expected", {{"verdict", row.run.expect.verdict}, {"by", row.run.expect.by}}},
                   {"outcome", outcomeName(row.outcome)},
                   {"why", row.why},
                   {"exit_code", row.exit_code},
                   {"earlier_tries", row.earlier_tries},
                   {"folder", jobFolder({}, row.run).generic_string()},
                   {"result", nullptr}};
  if (!row.verdict) return json;
  json["result"] = verdictFields(*row.verdict);
  json["result"]["report"] = reportLink(row);
  return json;
}

std::string dumped(const OrderedJson& json) {
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace

std::string summaryJson(const SuiteResult& result) {
  OrderedJson rows = OrderedJson::array();
  for (const SuiteRow& row : result.rows) rows.push_back(rowJson(row));
  OrderedJson json{{"schema_version", kSummarySchema},
                   {"suite", result.name},
                   {"title", result.title},
                   {"exit_code", result.exitCode()},
                   {"complete", result.count(Outcome::kNotRun) == 0},
                   {"summary", headline(result)},
                   {"image", result.image},
                   {"image_sha256", result.image_sha256},
                   {"kerfbench", result.bench_version},
                   {"part", result.part},
                   {"left_out", result.left_out}};
  OrderedJson counts = OrderedJson::object();
  for (const Outcome outcome :
       {Outcome::kAsExpected, Outcome::kNotAsExpected, Outcome::kBroken, Outcome::kNotRun})
    counts[outcomeName(outcome)] = result.count(outcome);
  json["counts"] = counts;
  json["runs"] = rows;
  json["digest"] = base::sha256(dumped(rows));
  return dumped(json);
}

}  // namespace kerfbench::suite
