// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "hil/base/yaml_reader.h"
#include "hil/desk/desk_request.h"

// Private to hil/desk.
namespace kerfbench::desk {

/// Something wrong with a job, at its place.
struct DeskIssue {
  std::filesystem::path file;  ///< Empty: the scenario itself.
  int line{};                  ///< From 1; 0: unknown.
  int column{};
  bool is_error{true};
  std::string key;  ///< With its sections; empty: none.
  std::string message;
};

/// A reader's faults, as issues of the text that it read, and of the files that this extends.
std::vector<DeskIssue> issuesOf(const std::vector<base::YamlReader::Fault>& faults,
                                const ScenarioText& scenario);

/// What an exception of the bench says, with a fault in each line as "file:line: key: message"; lines that
/// begin with no file belong to the one before.
std::vector<DeskIssue> issuesIn(std::string_view what, const ScenarioText& scenario);

/// Line and column of a key in a text, or of the nearest section around it; zeros where it has none.
struct TextPlace {
  int line{}, column{};
};
TextPlace placeOfKey(const std::string& text, std::string_view key);

nlohmann::json jsonOf(const std::vector<DeskIssue>& issues, const DeskRequest& request);

}  // namespace kerfbench::desk
