// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/earlier_suite.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/suite/suite_report.h"

namespace kerfbench::suite {

std::vector<std::string> namesNotAsExpected(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kSummary;
  const auto text = base::fileContent(path);
  if (!text) throw base::InputError(fmt::format("{}: holds no {}", folder.string(), kSummary));
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("schema_version", nlohmann::json()) != kSummarySchema)
    throw base::InputError(fmt::format("{}: is no summary that this bench reads", path.string()));
  std::vector<std::string> names;
  try {
    for (const auto& run : json.at("runs")) {
      if (run.at("outcome").get<std::string>() != outcomeName(Outcome::kAsExpected))
        names.push_back(run.at("name").get<std::string>());
    }
  } catch (const nlohmann::json::exception&) {
    throw base::InputError(fmt::format("{}: lacks what a summary has", path.string()));
  }
  if (names.empty())
    throw base::InputError(
        fmt::format("{}: all runs were as expected, nothing is to be repeated", folder.string()));
  return names;
}

}  // namespace kerfbench::suite
