// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/scenario_values.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/desk/yaml_layout.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kDeepestExtends = 8;
constexpr std::array<std::string_view, 6> kFreeSections{
    "layers", "wires", "firmware.lines", "firmware.outputs", "firmware.settings", "cameras.spot.controls"};

/// What `over` says goes over what `base` says, as base::YamlReader has it: section by section, null takes
/// away.
void overlay(ordered_json& base, const ordered_json& over) {
  for (const auto& [key, value] : over.items()) {
    if (value.is_null()) {
      base.erase(key);
    } else if (value.is_object() && base.contains(key) && base[key].is_object()) {
      overlay(base[key], value);
    } else {
      base[key] = value;
    }
  }
}

void flatten(const ordered_json& section, const std::string& prefix, ordered_json& flat) {
  for (const auto& [key, value] : section.items()) {
    const std::string path = prefix + key;
    if (value.is_object() && std::ranges::find(kFreeSections, path) == kFreeSections.end()) {
      flatten(value, path + ".", flat);
    } else if (!value.is_null()) {
      flat[path] = value;
    }
  }
}

ordered_json mappingOf(const std::string& text) {
  ordered_json value = valueOf(layoutOf(text));
  return value.is_object() ? value : ordered_json::object();
}

/// Text of a file of the size that a configuration may have; empty where there is none.
std::string configurationText(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kMostYamlBytes) return {};
  return base::fileContent(file).value_or("");
}

}  // namespace

ScenarioValues valuesOf(const ScenarioText& scenario) {
  std::vector<ordered_json> chain{mappingOf(scenario.text)};
  fs::path file = scenario.file;
  while (static_cast<int>(chain.size()) < kDeepestExtends) {
    const ordered_json& last = chain.back();
    if (!last.contains("extends") || !last["extends"].is_string()) break;
    file = file.parent_path() / last["extends"].get<std::string>();
    chain.push_back(mappingOf(configurationText(file)));
  }
  ScenarioValues values;
  ordered_json own = ordered_json::object();
  flatten(chain.front(), "", own);
  for (const auto& entry : own.items()) values.own.push_back(entry.key());
  ordered_json all = ordered_json::object();
  for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
    it->erase("extends");
    overlay(all, *it);
  }
  values.all = ordered_json::object();
  flatten(all, "", values.all);
  return values;
}

}  // namespace kerfbench::desk
