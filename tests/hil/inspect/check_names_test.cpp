// SPDX-License-Identifier: Apache-2.0
// Names in docs/reference/checks.md and the schema of verdict.json compared with those in the sources.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/docs/key_tables.h"

namespace kerfbench::inspect {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

std::string textOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Names that are given to checks in the rooms that make checks.
Names namesInTheSources() {
  const std::regex given(R"re(\.name = "([a-z_]+)")re");
  Names names;
  for (const char* room : {"hil/inspect", "hil/judge"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(KERFBENCH_SOURCE_DIR) / room)) {
      if (entry.path().extension() != ".cpp") continue;
      const std::string text = textOf(entry.path());
      for (auto it = std::sregex_iterator(text.begin(), text.end(), given); it != std::sregex_iterator();
           ++it)
        names.insert((*it)[1]);
    }
  }
  return names;
}

Names sectionsOfThePage() {
  std::istringstream page(docs::pageText("checks.md"));
  Names names;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("### ")) names.insert(line.substr(4));
  }
  return names;
}

TEST(CheckNames, AreTheSectionsOfTheirPage) {
  const Names names = namesInTheSources();
  EXPECT_GE(names.size(), 20U);
  EXPECT_EQ(sectionsOfThePage(), names);
}

TEST(CheckNames, AreThoseOfTheSchema) {
  const auto schema = nlohmann::json::parse(docs::pageText("verdict.schema.json"));
  const auto& listed =
      schema.at("properties").at("checks").at("items").at("properties").at("name").at("enum");
  EXPECT_EQ(Names(listed.begin(), listed.end()), namesInTheSources());
}

}  // namespace
}  // namespace kerfbench::inspect
