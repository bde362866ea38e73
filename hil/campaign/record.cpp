// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/campaign/run_files.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

OrderedJson numberOrNull(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? OrderedJson(*value) : OrderedJson(nullptr);
}

std::optional<double> optionalNumber(const OrderedJson& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<double>();
}

OrderedJson factorJson(const FactorValue& factor) {
  OrderedJson json{{"name", factor.factor}, {"value", factor.value}};
  if (factor.size) json["size"] = *factor.size;
  return json;
}

FactorValue factorFrom(const OrderedJson& json) {
  FactorValue factor{.factor = json.at("name").get<std::string>(),
                     .value = json.at("value").get<std::string>(),
                     .size = std::nullopt};
  if (json.contains("size")) factor.size = json.at("size").get<double>();
  return factor;
}

OrderedJson checkJson(const CheckRecord& check) {
  return {{"name", check.name},
          {"verdict", check.verdict},
          {"value", numberOrNull(check.value)},
          {"U", check.u},
          {"limit", numberOrNull(check.limit)},
          {"limit_is", check.lower ? "lower" : "upper"},
          {"unit", check.unit}};
}

CheckRecord checkFrom(const OrderedJson& json) {
  CheckRecord check;
  check.name = json.at("name").get<std::string>();
  check.verdict = json.at("verdict").get<std::string>();
  check.value = optionalNumber(json.at("value"));
  check.u = json.at("U").get<double>();
  check.limit = optionalNumber(json.at("limit"));
  check.lower = json.at("limit_is").get<std::string>() == "lower";
  check.unit = json.at("unit").get<std::string>();
  return check;
}

Record recordFromJson(const OrderedJson& json) {
  Record record;
  record.run = json.at("run").get<std::size_t>();
  record.base = json.at("base").get<std::string>();
  for (const OrderedJson& factor : json.at("factors")) record.factors.push_back(factorFrom(factor));
  if (!json.at("seed").is_null()) record.seed = json.at("seed").get<std::uint64_t>();
  record.outcome = json.at("outcome").get<std::string>();
  record.reason = json.at("reason").get<std::string>();
  for (const OrderedJson& check : json.at("checks")) record.checks.push_back(checkFrom(check));
  record.digest = json.at("digest").get<std::string>();
  return record;
}

std::string sumOf(const std::string& campaign, const std::string& line) {
  return base::sha256(campaign + "\n" + line + "\n");
}

}  // namespace

Record recordOf(const Campaign& campaign, const RunPlan& plan) {
  Record record;
  record.run = plan.index;
  record.base = campaign.bases.at(plan.base).stem().string();
  record.factors = plan.factors;
  for (FactorValue& factor : record.factors) factor.kind = 0;  // An index into the file, not a result.
  record.seed = plan.seed;
  return record;
}

void addVerdict(Record& record, const compare::RunFigures& figures) {
  record.outcome = figures.verdict;
  record.digest = figures.digest;
  for (const auto& [name, verdict] : figures.checks) {
    CheckRecord check{.name = name,
                      .verdict = verdict.verdict,
                      .unit = verdict.unit,
                      .value = std::nullopt,
                      .limit = std::nullopt};
    if (std::isfinite(verdict.limit)) check.limit = verdict.limit;
    const auto figure = std::ranges::find_if(figures.figures, [&](const compare::Figure& f) {
      return f.of == compare::Figure::Of::kCheck && f.place == check.name;
    });
    if (figure != figures.figures.end()) {
      check.value = figure->value;
      check.u = 2.0 * figure->sigma;
      check.lower = figure->better == compare::Better::kLarger;
    }
    record.checks.push_back(std::move(check));
  }
}

std::string lineOf(const Record& record) {
  OrderedJson json{{"run", record.run}, {"base", record.base}, {"factors", OrderedJson::array()}};
  for (const FactorValue& factor : record.factors) json["factors"].push_back(factorJson(factor));
  json["seed"] = record.seed ? OrderedJson(*record.seed) : OrderedJson(nullptr);
  json["outcome"] = record.outcome;
  json["reason"] = record.reason;
  json["checks"] = OrderedJson::array();
  for (const CheckRecord& check : record.checks) json["checks"].push_back(checkJson(check));
  json["digest"] = record.digest;
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

Record recordFrom(const std::string& line) {
  const OrderedJson json = OrderedJson::parse(line, nullptr, false);
  try {
    return recordFromJson(json);
  } catch (const OrderedJson::exception& e) {
    throw base::InputError(fmt::format("is no record of a run: {}", base::printable(e.what(), 120)));
  }
}

RecordFolder::RecordFolder(fs::path folder, std::string campaign)
    : folder_(std::move(folder)), campaign_(std::move(campaign)) {}

fs::path RecordFolder::fileOf(std::size_t run) const {
  constexpr std::size_t kInOneFolder = 1000;
  return folder_ / fmt::format("{:03}", run / kInOneFolder) / (runName(run) + ".json");
}

void RecordFolder::write(const Record& record) const {
  const fs::path file = fileOf(record.run);
  fs::create_directories(file.parent_path());
  const std::string line = lineOf(record);
  const OrderedJson seal{{"campaign", campaign_}, {"sha256", sumOf(campaign_, line)}};
  base::writeFileAtomically(file, line + "\n" + seal.dump() + "\n");
}

RecordFolder::Found RecordFolder::find(std::size_t run) const {
  const fs::path file = fileOf(run);
  const auto damaged = [&](const std::string& why) {
    return Found{{}, fmt::format("{}: {}", file.string(), why)};
  };
  const std::optional<std::string> content = base::fileContent(file);
  if (!content) {
    if (errno == ENOENT || errno == ENOTDIR) return {};
    return damaged(std::generic_category().message(errno));
  }
  const std::size_t end = content->find('\n');
  if (end == std::string::npos) return damaged("is cut off");
  const std::string line = content->substr(0, end);
  const OrderedJson seal = OrderedJson::parse(content->substr(end + 1), nullptr, false);
  if (!seal.is_object() || !seal.contains("campaign") || !seal.contains("sha256"))
    return damaged("is cut off");
  if (seal["campaign"] != campaign_) return damaged("is of another campaign, or of other files");
  if (seal["sha256"] != sumOf(campaign_, line)) return damaged("is not as it was written: its sum differs");
  try {
    if (recordFrom(line).run != run) return damaged("is of another run");
  } catch (const base::InputError& e) {
    return damaged(e.what());
  }
  return {line, {}};
}

}  // namespace kerfbench::campaign
