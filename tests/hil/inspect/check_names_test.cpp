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
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hil/inspect/check_names.h"
#include "tests/docs/key_tables.h"

namespace kerfbench::inspect {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

std::string textOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The room of the checks of cuts in space, which are no checks of a run.
const fs::path kSpace = fs::path(KERFBENCH_SOURCE_DIR) / "hil/inspect/space";

/// Names that are given to checks in these folders, without those of cuts in space unless these are asked
/// for.
Names namesIn(const std::vector<fs::path>& folders) {
  const std::regex given(R"re(\.name = "([a-z_]+)")re");
  Names names;
  for (const fs::path& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".cpp") continue;
      if (folder != kSpace && entry.path().parent_path() == kSpace) continue;
      const std::string text = textOf(entry.path());
      for (auto it = std::sregex_iterator(text.begin(), text.end(), given); it != std::sregex_iterator();
           ++it)
        names.insert((*it)[1]);
    }
  }
  return names;
}

Names namesInTheSources() {
  const fs::path root(KERFBENCH_SOURCE_DIR);
  return namesIn({root / "hil/inspect", root / "hil/judge"});
}

Names sectionsOfThePage(const std::string& name) {
  std::istringstream page(docs::pageText(name));
  Names names;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("### ")) names.insert(line.substr(4));
  }
  return names;
}

TEST(CheckNames, AreTheSectionsOfTheirPage) {
  const Names names = namesInTheSources();
  EXPECT_GE(names.size(), 20U);
  EXPECT_EQ(sectionsOfThePage("checks.md"), names);
}

TEST(CheckNames, AreThoseThatAPlanMayName) {
  EXPECT_EQ(Names(kCheckNames.begin(), kCheckNames.end()), namesInTheSources());
  EXPECT_EQ(Names(kCheckNames.begin(), kCheckNames.end()).size(), kCheckNames.size());
}

TEST(CheckNames, OfCutsInSpaceAreTheSectionsOfTheirPage) {
  const Names names = namesIn({kSpace});
  EXPECT_EQ(names.size(), 4U);
  EXPECT_EQ(sectionsOfThePage("fold.md"), names);
}

TEST(CheckNames, AreThoseOfTheSchema) {
  const auto schema = nlohmann::json::parse(docs::pageText("verdict.schema.json"));
  const auto& listed =
      schema.at("properties").at("checks").at("items").at("properties").at("name").at("enum");
  EXPECT_EQ(Names(listed.begin(), listed.end()), namesInTheSources());
}

}  // namespace
}  // namespace kerfbench::inspect
