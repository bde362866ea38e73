// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hil/serve/work_folder.h"

// Private to hil/serve.
namespace kerfbench::serve {

/// What the service page lists of a folder: calibrations by hand, and the files that they are made of.
struct ServiceLists {
  /// Folders of calibrations by hand, by their steps.json, the one that was used last first: {"path"}.
  nlohmann::json folders = nlohmann::json::array();
  /// {"path", "kind": "scan" | "photograph" | "tiles" | "scan-list" | "camera" | "scanner" | "target" |
  /// "table", "id"?, "date"?}, by their names.
  nlohmann::json files = nlohmann::json::array();
};

/// `names`: all files, as the list of the folder has them. What single runs have written is passed by.
ServiceLists serviceLists(const WorkFolder& files, const std::vector<std::string>& names);

}  // namespace kerfbench::serve
