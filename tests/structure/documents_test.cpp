// SPDX-License-Identifier: Apache-2.0
// Documents against the tree: links lead somewhere, constants have the values of the code, what comments cite
// is listed, and every decision is in the index.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/structure/source_text.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;

/// Every page of the project. Build folders, packages of others and what begins with a dot are not part of
/// it.
std::vector<fs::path> pages() {
  std::vector<fs::path> found;
  for (auto entry = fs::recursive_directory_iterator(sourceRoot());
       entry != fs::recursive_directory_iterator(); ++entry) {
    const std::string name = entry->path().filename().string();
    const bool is_outside = entry.depth() == 0 && (name == "build" || name == "results");
    if (entry->is_directory() && (is_outside || name == "node_modules" || name.starts_with("."))) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file() && entry->path().extension() == ".md") {
      found.push_back(entry->path());
    }
  }
  std::ranges::sort(found);
  return found;
}

/// Text without fenced and inline code: brackets in code are no links.
std::string proseOf(const std::string& page) {
  std::istringstream lines(page);
  std::string prose;
  bool fenced = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) fenced = !fenced;
    if (fenced || line.starts_with("    ")) continue;
    bool code = false;
    for (const char c : line) {
      if (c == '`') code = !code;
      prose += code ? ' ' : c;
    }
    prose += '\n';
  }
  return prose;
}

/// Targets of [text](target), ![text](target), [name]: target, and href="target", src="target".
std::vector<std::string> targetsOf(const std::string& page) {
  static const std::regex kTarget(
      R"re(\]\(\s*<?([^)\s>]+)>?(?:\s+"[^"]*")?\s*\)|(?:^|\n)\[[^\]]+\]:\s*(\S+)|(?:href|src)="([^"]+)")re");
  const std::string prose = proseOf(page);
  std::vector<std::string> targets;
  for (std::sregex_iterator match(prose.begin(), prose.end(), kTarget), end; match != end; ++match) {
    for (std::size_t group = 1; group < match->size(); ++group) {
      if ((*match)[group].matched) targets.push_back((*match)[group]);
    }
  }
  return targets;
}

/// Anchor of a heading as forges make it: lower case, without punctuation, hyphens for blanks.
std::string anchorOf(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (c == ' ' || c == '-') {
      anchor += '-';
    } else if (isWordCharacter(c) || static_cast<unsigned char>(c) >= 0x80U) {
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return anchor;
}

bool hasAnchor(const std::string& page, const std::string& anchor) {
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t text = line.find_first_not_of('#');
    if (text == 0 || text == std::string::npos || line[text] != ' ') continue;
    if (anchorOf(line.substr(text + 1)) == anchor) return true;
  }
  return false;
}

bool isElsewhere(const std::string& target) {
  return target.find("://") != std::string::npos || target.starts_with("mailto:") ||
         target.starts_with("data:");
}

/// Fault of a link of a page; nullopt if it leads to a file or heading that exists.
std::optional<std::string> brokenLink(const fs::path& page, const std::string& text,
                                      const std::string& target) {
  const std::size_t hash = target.find('#');
  const std::string file = target.substr(0, hash);
  const fs::path path = file.empty() ? page : page.parent_path() / file;
  if (!fs::exists(path)) return "there is no " + file;
  if (hash == std::string::npos || path.extension() != ".md") return std::nullopt;
  if (hasAnchor(file.empty() ? text : textOf(path), target.substr(hash + 1))) return std::nullopt;
  return "there is no heading " + target.substr(hash);
}

TEST(Documents, LinksLeadToFilesAndHeadingsThatExist) {
  std::size_t links = 0;
  for (const fs::path& page : pages()) {
    const std::string text = textOf(page);
    for (const std::string& target : targetsOf(text)) {
      if (isElsewhere(target)) continue;
      ++links;
      const auto broken = brokenLink(page, text, target);
      EXPECT_FALSE(broken) << fs::relative(page, sourceRoot()).string() << ": (" << target
                           << "): " << broken.value_or("");
    }
  }
  EXPECT_GT(links, 100U);
}

TEST(Documents, LinksOfAllKindsAreSeenAndCodeIsNone) {
  EXPECT_EQ(targetsOf("[a](b.md) ![c](d.png \"e\") `[f](g)`\n    [h](i)\n```\n[j](k)\n```\n[l]: m.md\n<img "
                      "src=\"n.png\">"),
            (std::vector<std::string>{"b.md", "d.png", "m.md", "n.png"}));
  EXPECT_EQ(anchorOf("What is *not* listed: 3 things"), "what-is-not-listed-3-things");
}

struct Constant {
  std::string name;
  std::string value;
  std::string file;
};

/// Rows "| `name` | `value` | [text](../file) | …".
std::vector<Constant> constantsOf(const std::string& page) {
  static const std::regex kRow(R"re(^\| `([^`]+)` \| `([^`]+)` \| \[[^\]]+\]\(\.\./([^)]+)\) \|.*$)re");
  std::istringstream lines(page);
  std::vector<Constant> constants;
  std::smatch row;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, row, kRow)) constants.push_back({row[1], row[2], row[3]});
  }
  return constants;
}

/// Source without blanks and without comments after //.
std::string denseOf(const std::string& source) {
  std::istringstream lines(source);
  std::string dense;
  for (std::string line; std::getline(lines, line);) {
    for (const char c : line.substr(0, line.find("//"))) {
      if (std::isspace(static_cast<unsigned char>(c)) == 0) dense += c;
    }
  }
  return dense;
}

/// True where the source says name = value or name{value}, up to the end of the declaration.
bool declares(const std::string& dense, const Constant& constant) {
  const std::string value = denseOf(constant.value);
  for (const std::string& text :
       {constant.name + "=" + value, constant.name + "{" + value + "}", constant.name + value}) {
    for (std::size_t at = dense.find(text); at != std::string::npos; at = dense.find(text, at + 1)) {
      const std::size_t end = at + text.size();
      if (end < dense.size() && (dense[end] == ';' || dense[end] == ',')) return true;
    }
  }
  return false;
}

TEST(Documents, ConstantsHaveTheValuesOfTheCode) {
  const std::vector<Constant> constants = constantsOf(textOf(sourceRoot() / "docs/CONSTANTS.md"));
  EXPECT_GT(constants.size(), 200U);
  for (const Constant& constant : constants) {
    const fs::path path = sourceRoot() / constant.file;
    ASSERT_TRUE(fs::is_regular_file(path)) << constant.name << ": there is no " << constant.file;
    EXPECT_TRUE(declares(denseOf(textOf(path)), constant))
        << constant.file << " has another " << constant.name << " than " << constant.value;
  }
}

TEST(Documents, AConstantOfAnotherValueIsNoticed) {
  const std::string dense = denseOf("constexpr double kFar_mm = 1.5;  // was 1.6\nLensBlur kBlur{0.7, 0.1};");
  EXPECT_TRUE(declares(dense, {"kFar_mm", "1.5", ""}));
  EXPECT_TRUE(declares(dense, {"kBlur", "{0.7, 0.1}", ""}));
  EXPECT_FALSE(declares(dense, {"kFar_mm", "1.6", ""}));
  EXPECT_FALSE(declares(dense, {"kFar_mm", "1", ""}));
}

/// "Author 2004" in the comments of a source, which may break between the two.
std::vector<std::pair<std::string, std::string>> citationsOf(const std::string& source) {
  static const std::regex kBreak(R"re(\n\s*(///?|\*)\s*)re");
  static const std::regex kCitation(R"re(\b([A-Z][a-z]+)( et al\.?)?,? \(?((19|20)[0-9]{2})\b)re");
  const std::string text = std::regex_replace(source, kBreak, " ");
  std::vector<std::pair<std::string, std::string>> citations;
  for (std::sregex_iterator match(text.begin(), text.end(), kCitation), last; match != last; ++match)
    citations.emplace_back((*match)[1], (*match)[3]);
  return citations;
}

/// Paragraphs, with each row of a table as one.
std::vector<std::string> entriesOf(const std::string& page) {
  std::istringstream lines(page);
  std::vector<std::string> entries(1);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.starts_with("|")) entries.emplace_back();
    entries.back() += line + " ";
  }
  return entries;
}

TEST(Documents, ReferencesListWhatCommentsCite) {
  const std::vector<std::string> entries = entriesOf(textOf(sourceRoot() / "docs/references.md"));
  std::size_t cited = 0;
  for (const char* top : {"twin", "hil", "firmware_under_test"}) {
    for (const auto& file : fs::recursive_directory_iterator(sourceRoot() / top)) {
      const fs::path extension = file.path().extension();
      if (extension != ".h" && extension != ".cpp" && extension != ".c") continue;
      for (const auto& citation : citationsOf(textOf(file.path()))) {
        const auto& [author, year] = citation;
        ++cited;
        const bool listed = std::ranges::any_of(entries, [&citation](const std::string& entry) {
          return entry.find(citation.first) != std::string::npos &&
                 entry.find(citation.second) != std::string::npos;
        });
        EXPECT_TRUE(listed) << fs::relative(file.path(), sourceRoot()).string() << " cites " << author << " "
                            << year << ", which docs/references.md does not list";
      }
    }
  }
  EXPECT_GT(cited, 30U);
}

TEST(Documents, ACitationIsFoundWhereItsLineBreaks) {
  const auto found =
      citationsOf("/// by recursion (Ramshaw\n/// 1989), not in 2048 pixels\n// Cheng et al. 2014, eq. 1");
  EXPECT_EQ(found,
            (std::vector<std::pair<std::string, std::string>>{{"Ramshaw", "1989"}, {"Cheng", "2014"}}));
}

TEST(Documents, EveryDecisionHasItsPartsAndIsInTheIndex) {
  const fs::path folder = sourceRoot() / "docs/explanation/decisions";
  const std::string index = textOf(folder / "README.md");
  std::size_t number = 0;
  std::vector<fs::path> records;
  for (const auto& file : fs::directory_iterator(folder)) {
    if (file.path().filename() != "README.md") records.push_back(file.path());
  }
  std::ranges::sort(records);
  EXPECT_GT(records.size(), 50U);
  for (const fs::path& record : records) {
    const std::string name = record.filename().string();
    const std::string text = textOf(record);
    // Numbers follow each other, so none is given twice.
    EXPECT_EQ(name.substr(0, 4), fmt::format("{:03}-", ++number));
    EXPECT_NE(index.find("](" + name + ")"), std::string::npos) << name << " is not in the index";
    for (const char* part : {"**Context.** ", "**Decision.** ", "**Consequence.** "})
      EXPECT_NE(text.find(part), std::string::npos) << name << " has no " << part;
  }
}

}  // namespace
}  // namespace kerfbench::test
