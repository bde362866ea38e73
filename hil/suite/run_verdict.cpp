// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/run_verdict.h"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/report/run_report.h"

namespace kerfbench::suite {
namespace {

using Json = nlohmann::json;

constexpr int kVerdictSchema = 1;

std::string textOf(const Json& json, const char* key) { return json.at(key).get<std::string>(); }

double numberOf(const Json& json, const char* key) {
  const Json& value = json.at(key);
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

/// @throws std::out_of_range for a word that is no verdict.
inspect::Verdict verdictNamed(const std::string& name) {
  using inspect::Verdict;
  for (const Verdict verdict : {Verdict::kPass, Verdict::kNotProven, Verdict::kFail, Verdict::kInvalid}) {
    if (inspect::verdictName(verdict) == name) return verdict;
  }
  throw std::out_of_range(name);
}

inspect::Check checkOf(const Json& json) {
  inspect::Check check;
  check.name = textOf(json, "name");
  check.title = textOf(json, "title");
  check.subject = textOf(json, "subject");
  check.unit = textOf(json, "unit");
  check.value = numberOf(json, "value");
  check.limit = numberOf(json, "limit");
  check.upper = textOf(json, "limit_is") == "upper";
  check.u = numberOf(json, "expanded_uncertainty");
  check.verdict = verdictNamed(textOf(json, "verdict"));
  check.explanation = textOf(json, "explanation");
  return check;
}

RunVerdict verdictOf(const Json& json) {
  RunVerdict v;
  v.verdict = textOf(json, "verdict");
  v.exit_code = inspect::exitCode(verdictNamed(v.verdict));
  v.summary = textOf(json, "summary");
  v.likely_cause = textOf(json, "likely_cause");
  v.digest = textOf(json, "digest");
  v.inputs_digest = textOf(json, "inputs_digest");
  v.firmware = textOf(json, "firmware");
  v.firmware_sha256 = json.at("versions").value("firmware sha256", std::string());
  v.seed = json.at("seed").get<std::uint64_t>();
  v.imperfections = textOf(json.at("model"), "imperfections");
  v.twin = textOf(json.at("model"), "twin");
  v.virtual_s = json.at("virtual_s").get<double>();
  for (const Json& check : json.at("checks")) v.checks.push_back(checkOf(check));
  v.problems = json.at("problems").get<std::vector<std::string>>();
  for (const Json& reservation : json.at("reservations"))
    v.reservations.push_back(textOf(reservation, "text"));
  return v;
}

}  // namespace

RunVerdict readRunVerdict(const std::filesystem::path& results) {
  const std::filesystem::path path = results / "verdict.json";
  const auto text = base::fileContent(path);
  if (!text) throw base::InputError(fmt::format("{}: is not there", path.string()));
  const Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object()) throw base::InputError(fmt::format("{}: is no verdict", path.string()));
  if (const Json version = json.value("schema_version", Json()); version != kVerdictSchema) {
    throw base::InputError(fmt::format("{}: schema_version is {}, and this bench reads {}", path.string(),
                                       version.dump(), kVerdictSchema));
  }
  try {
    return verdictOf(json);
  } catch (const Json::exception& e) {
    throw base::InputError(fmt::format("{}: lacks what a verdict of schema_version {} has: {}", path.string(),
                                       kVerdictSchema, base::printable(e.what(), 200)));
  } catch (const std::out_of_range& e) {
    throw base::InputError(fmt::format("{}: {} is no verdict", path.string(), base::inQuotes(e.what())));
  }
}

const inspect::Check* nearestToLimit(const RunVerdict& verdict) {
  const inspect::Check* nearest = nullptr;
  double most = -1.0;
  for (const inspect::Check& check : verdict.checks) {
    const double share = inspect::shareOfLimit(check);
    if (share > most) nearest = &check;
    most = std::max(most, share);
  }
  return nearest;
}

std::string figuresOf(const inspect::Check& check) {
  const std::string u = check.u > 0.0 ? " ± " + report::checkNumber(check, check.u) : std::string();
  return fmt::format("{}{} (limit {}{})", report::checkNumber(check, check.value), u, check.upper ? "" : "≥ ",
                     report::checkNumber(check, check.limit));
}

}  // namespace kerfbench::suite
