// SPDX-License-Identifier: Apache-2.0
// Every name has one meaning. Two types, or two functions with the same parameters, that share a qualified
// name are the same to the linker, which then takes either.
#include <gtest/gtest.h>

#include "tests/structure/source_text.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using kerfbench::test::sourceRoot;

struct Definition {
  std::string name;  // "kerfbench::vision::trackSpot(FrameSource&, int)"
  std::string file;
};

/// Parameters without names and defaults: "const Dieline&, double".
std::string typesOf(const std::string& parameters) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : parameters) {
    if (c == '<' || c == '(' || c == '[' || c == '{') ++depth;
    if (c == '>' || c == ')' || c == ']' || c == '}') --depth;
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  static const std::regex kDefault(R"(\s*=.*$)");
  static const std::regex kName(R"(([\w>&*\]])\s+(\w+)\s*$|([&*>])(\w+)\s*$)");
  std::string text;
  for (std::string part : parts) {
    part = std::regex_replace(part, kDefault, "");
    part = std::regex_replace(part, kName, "$1$3");
    text += (text.empty() ? "" : ",") + std::regex_replace(part, std::regex(R"(\s+)"), "");
  }
  return text;
}

/// Definitions of a file at namespace scope with external linkage, as clang-format lays them out: each begins
/// in the first column, and a namespace's end says so.
std::vector<Definition> definitionsIn(const fs::path& path, const std::string& file) {
  static const std::regex kOpen(R"(^(?:inline )?namespace ([\w:]+) \{)");
  static const std::regex kClose(R"(^\}  // namespace( [\w:]+)?$)");
  static const std::regex kType(R"(^(?:struct|class|enum class) (\w+)(?: final)?(?: :.*)? ?\{)");
  static const std::regex kFunction(
      R"(^(?!static |using |typedef |friend |return )[\w:<>,&*\[\] ]*?[\w>&*] ?\b(\w+)\((.*)\)(?: const)?(?: noexcept)? \{)");
  std::vector<Definition> found;
  std::vector<std::string> scopes;  // Open namespaces; "" is an anonymous one.
  std::ifstream stream(path);
  std::smatch match;
  std::string statement;
  for (std::string line; std::getline(stream, line);) {
    if (line == "namespace {") {
      scopes.emplace_back();
    } else if (std::regex_search(line, match, kOpen)) {
      scopes.push_back(match[1]);
    } else if (std::regex_search(line, match, kClose)) {
      if (!scopes.empty()) scopes.pop_back();
    } else {
      const bool begins = !line.empty() && (std::isalpha(static_cast<unsigned char>(line[0])) != 0);
      if (begins) statement.clear();
      if (begins || (!statement.empty() && line.starts_with("    "))) statement += (begins ? "" : " ") + line;
      const bool whole = statement.ends_with("{") || statement.find(" { ") != std::string::npos;
      if (!whole || scopes.empty() || std::ranges::find(scopes, "") != scopes.end()) continue;
      std::string scope;
      for (const std::string& s : scopes) scope += s + "::";
      if (std::regex_search(statement, match, kType)) {
        found.push_back({scope + match[1].str(), file});
      } else if (!statement.starts_with("template") && std::regex_search(statement, match, kFunction) &&
                 statement.find("::" + match[1].str() + "(") == std::string::npos) {
        found.push_back({scope + match[1].str() + "(" + typesOf(match[2]) + ")", file});
      }
      statement.clear();
    }
  }
  return found;
}

/// True for one of two adapters to a library, of which a build has one.
bool isAlternative(const std::string& file) { return file == "hil/source/gpio/chips_libgpiod2.cpp"; }

TEST(Names, AreDefinedOnce) {
  std::map<std::string, std::string> file_of;
  int functions = 0;
  for (const char* top : {"twin", "hil", "firmware_under_test/planner"}) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h") continue;
      const std::string file = fs::relative(entry.path(), sourceRoot()).string();
      if (isAlternative(file)) continue;
      for (const Definition& definition : definitionsIn(entry.path(), file)) {
        functions += definition.name.ends_with(")") ? 1 : 0;
        const auto [other, is_new] = file_of.emplace(definition.name, file);
        EXPECT_TRUE(is_new) << definition.name << " is in " << other->second << " and in " << file;
      }
    }
  }
  EXPECT_GT(file_of.size(), 1000U);
  EXPECT_GT(functions, 500);
}

TEST(Names, OfTwoDefinitionsAreSeenToBeTheSame) {
  const fs::path path = fs::path(testing::TempDir()) / "two_definitions.cpp";
  std::ofstream(path)
      << "namespace kerfbench::vision {\n"
         "double medianOf(std::vector<double> values) {\n}\n"
         "namespace {\ndouble hidden(int a) {\n}\n}  // namespace\n"
         "double medianOf(std::vector<double> v) { return v[0]; }\n"
         "double medianOf(const std::vector<int>& v,\n                double other = 1.0) {\n}\n"
         "struct Thing {\n}\n"
         "}  // namespace kerfbench::vision\n";
  std::multiset<std::string> names;
  for (const Definition& definition : definitionsIn(path, "a")) names.insert(definition.name);
  EXPECT_EQ(names, (std::multiset<std::string>{"kerfbench::vision::Thing",
                                               "kerfbench::vision::medianOf(conststd::vector<int>&,double)",
                                               "kerfbench::vision::medianOf(std::vector<double>)",
                                               "kerfbench::vision::medianOf(std::vector<double>)"}))
      << "as typesOf() writes them";
  fs::remove(path);
}

/// Retired words of an earlier vocabulary. They are in two parts, so that this file has none of them.
TEST(Names, AreTheFieldsOwn) {
  const std::vector<std::string> retired{
      std::string("Controller") + "Ear",   std::string("hear") + "Controller",
      std::string("Controller") + "Words", std::string("Heard") + "Pins",
      std::string("Pin") + "Sums",         std::string("keep") + "Evidence",
      std::string("laid") + "Down",        std::string("the") + "_case",
      std::string("Bench") + "Options",    std::string("gra") + "vest",
      std::string("straigh") + "ten(",     std::string("un") + "bend(",
      std::string("Drawn") + "Machine"};
  for (const char* top : {"twin", "hil", "firmware_under_test", "tests", "docs"}) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h" && extension != ".md") continue;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      for (const std::string& word : retired)
        EXPECT_EQ(text.find(word), std::string::npos) << entry.path().string() << ": " << word;
    }
  }
}

}  // namespace
