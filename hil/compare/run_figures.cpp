// SPDX-License-Identifier: Apache-2.0
#include "hil/compare/run_figures.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/input_error.h"
#include "hil/base/input_file.h"
#include "hil/base/text.h"
#include "hil/judge/results_list.h"

namespace kerfbench::compare {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kSchemaVersion = 1;
constexpr double kCoverage =
    2.0;  // Expanded uncertainties are of two standard ones (docs/reference/checks.md).
constexpr std::size_t kMostTold = 5;
constexpr std::size_t kFewestFrames = 5;

/// A verdict, as one that this version of the bench wrote.
class VerdictReader {
 public:
  VerdictReader(const fs::path& folder, const Json& json) : folder_(folder), json_(json) {}

  RunFigures read() {
    run_.folder = folder_;
    readHead();
    for (const Json& check : json_.at("checks")) addCheck(check);
    for (const Json& check : json_.at("not_judged")) {
      if (check.at("applies").get<bool>()) run_.not_judged[text(check, "name")] = text(check, "reason");
    }
    for (const Json& entity : json_.at("entities")) addEntity(entity);
    for (const Json& joint : json_.at("joints")) addJoint(joint);
    for (const Json& cut : json_.at("cuts").at("list")) addCut(cut);
    return std::move(run_);
  }

 private:
  static std::string text(const Json& json, const char* key) { return json.at(key).get<std::string>(); }

  static std::string textOr(const Json& json, const char* key) {
    return json.contains(key) && json.at(key).is_string() ? text(json, key) : std::string();
  }

  void readHead() {
    run_.scenario = text(json_, "scenario");
    run_.machine = text(json_, "machine");
    run_.firmware = text(json_, "firmware");
    run_.serial_number = textOr(json_, "serial_number");
    run_.verdict = text(json_, "verdict");
    run_.digest = text(json_, "digest");
    run_.inputs_digest = text(json_, "inputs_digest");
    run_.seed = json_.at("seed").get<std::uint64_t>();
    run_.imperfections = text(json_.at("model"), "imperfections");
    run_.twin = text(json_.at("model"), "twin");
    const Json& versions = json_.at("versions");
    (void)versions.get_ref<const Json::object_t&>();  // throws for what is no object
    run_.bench_version = textOr(versions, "kerfbench");
    run_.firmware_sha256 = textOr(versions, "firmware sha256");
    run_.firmware_version = textOr(versions, "controller");
    for (const Json& input : json_.at("inputs")) run_.inputs[text(input, "file")] = text(input, "sha256");
  }

  /// Adds a figure unless its value was not measured.
  void add(Figure figure, const Json& value, const Json& uncertainty, double of_one_sigma) {
    if (value.is_null()) return;
    figure.value = value.get<double>();
    figure.sigma = uncertainty.is_null() ? 0.0 : std::abs(uncertainty.get<double>()) / of_one_sigma;
    run_.figures.push_back(std::move(figure));
  }

  void addCheck(const Json& check) {
    const std::string name = text(check, "name");
    const Json& limit = check.at("limit");
    run_.checks[name] = {text(check, "verdict"), text(check, "subject"),
                         limit.is_null() ? std::nan("") : limit.get<double>(), text(check, "unit")};
    add({.of = Figure::Of::kCheck,
         .place = name,
         .quantity = "value",
         .unit = text(check, "unit"),
         .better = text(check, "limit_is") == "lower" ? Better::kLarger : Better::kSmaller},
        check.at("value"), check.at("expanded_uncertainty"), kCoverage);
  }

  static std::string entityPlace(const Json& json) {
    const int entity = json.at("entity").get<int>();
    const std::string unit = fmt::format("unit {}", json.at("unit").get<int>());
    return entity < 0 ? unit + ", along no drawn line" : fmt::format("{}, E{}", unit, entity);
  }

  void addEntity(const Json& entity) {
    const std::string place = entityPlace(entity);
    const auto measured = [&](const char* quantity, const char* uncertainty, Better better) {
      add({.of = Figure::Of::kEntity, .place = place, .quantity = quantity, .unit = "mm", .better = better},
          entity.at(quantity), entity.at(uncertainty), kCoverage);
    };
    measured("worst_mm", "worst_U_mm", Better::kNearZero);
    measured("rms_mm", "rms_U_mm", Better::kSmaller);
    measured("width_mm", "width_U_mm", Better::kNeither);
    measured("circularity_mm", "circularity_U_mm", Better::kSmaller);
    const auto counted = [&](const char* quantity, const char* unit, Better better) {
      add({.of = Figure::Of::kEntity, .place = place, .quantity = quantity, .unit = unit, .better = better},
          entity.at(quantity), Json(), 1.0);
    };
    counted("coverage", "", Better::kLarger);
    counted("uncut_mm", "mm", Better::kSmaller);
  }

  void addJoint(const Json& joint) {
    const int out = joint.at("entity_out").get<int>();
    const std::string place = fmt::format("{}, {}{} {}", entityPlace(joint), text(joint, "kind"),
                                          out >= 0 ? fmt::format(" to E{}", out) : std::string(),
                                          joint.at("at_start").get<bool>() ? "at its start" : "at its end");
    add({.of = Figure::Of::kJoint, .place = place, .quantity = "value", .unit = "mm"}, joint.at("value"),
        joint.at("U"), kCoverage);
  }

  void addCut(const Json& cut) {
    // A cut that begins where lines meet may be seen as a few frames on one and the rest on another.
    if (cut.at("frames").get<std::size_t>() < kFewestFrames) return;
    // The order in time tells several cuts of one line apart.
    const std::string along = entityPlace(cut);
    const int number = ++cuts_along_[along];
    const std::string place = number == 1 ? along : fmt::format("{}, cut {} of it", along, number);
    struct Quantity {
      const char *value, *uncertainty, *unit;
      double of_one_sigma;
      Better better;
    };
    constexpr std::array<Quantity, 7> kQuantities{{
        {"drift_mm", "drift_sigma_mm", "mm", 1.0, Better::kNearZero},
        {"slope_mm_s", "slope_sigma_mm_s", "mm/s", 1.0, Better::kNearZero},
        {"offset_mm", "offset_sigma_mm", "mm", 1.0, Better::kNearZero},
        {"excursion_mm", "excursion_U_mm", "mm", kCoverage, Better::kSmaller},
        {"peak_mm", "peak_U_mm", "mm", kCoverage, Better::kSmaller},
        {"rms_mm", "rms_U_mm", "mm", kCoverage, Better::kSmaller},
        {"top_speed_mm_s", "top_speed_U_mm_s", "mm/s", kCoverage, Better::kNeither},
    }};
    for (const Quantity& q : kQuantities) {
      add({.of = Figure::Of::kCut, .place = place, .quantity = q.value, .unit = q.unit, .better = q.better},
          cut.at(q.value), cut.at(q.uncertainty), q.of_one_sigma);
    }
  }

  fs::path folder_;
  const Json& json_;
  RunFigures run_;
  std::map<std::string, int> cuts_along_;
};

void refuseChanged(const fs::path& folder) {
  const std::vector<std::string> changes = judge::changedSinceListed(folder);
  if (changes.empty()) return;
  std::string told;
  for (std::size_t i = 0; i < std::min(changes.size(), kMostTold); ++i)
    told += (i == 0 ? "" : "; ") + changes[i];
  if (changes.size() > kMostTold) told += fmt::format("; and {} more", changes.size() - kMostTold);
  throw base::InputError(fmt::format("{}: is not what a run wrote: {}", folder.string(), told));
}

Json verdictIn(const fs::path& folder) {
  const fs::path path = folder / "verdict.json";
  const base::InputContent content = base::readInput(path, base::kLargestRecord_bytes);
  if (content.error == ENOENT)
    throw base::InputError(
        fmt::format("{}: has no verdict.json: what is in it is no verdict of a run", folder.string()));
  if (!content.bytes) throw base::InputError(fmt::format("{}: {}", path.string(), content.refusal));
  Json json = Json::parse(*content.bytes, nullptr, false);
  if (!json.is_object()) throw base::InputError(fmt::format("{}: is no verdict", path.string()));
  const auto version = json.find("schema_version");
  if (version == json.end() || *version != kSchemaVersion) {
    throw base::InputError(fmt::format(
        "{}: schema_version is {}, and this bench reads {}: run that release again with it", path.string(),
        version == json.end() ? std::string("missing") : version->dump(), kSchemaVersion));
  }
  return json;
}

}  // namespace

RunFigures readRunFigures(const fs::path& folder, Trust trust) {
  if (trust == Trust::kByItsSums) refuseChanged(folder);
  const Json json = verdictIn(folder);
  try {
    return VerdictReader(folder, json).read();
  } catch (const Json::exception& e) {
    throw base::InputError(fmt::format("{}: lacks what a verdict of schema_version {} has: {}",
                                       (folder / "verdict.json").string(), kSchemaVersion,
                                       base::printable(e.what(), 200)));
  }
}

int verdictRank(const std::string& verdict) {
  if (verdict == "PASS") return 0;
  if (verdict == "NOT PROVEN") return 1;
  return verdict == "FAIL" ? 2 : 3;
}

}  // namespace kerfbench::compare
