// SPDX-License-Identifier: Apache-2.0
// Figures on pages against the sources that they were measured with. A line
//
//     *Figures of commit 0123abc of 2026-11-23, seed 1, by `command`; of sources `hil/vision hil/gauge`,
//     0123456789ab.*
//
// states what the paragraph or table before it, or the whole page that a command writes, was made with; the
// last word is the digest of these folders and files then. When the sources change, the line must say so:
// "; older than their sources.*" in place of ".*". `./bench figures` puts that right on all pages;
// tests/figures/stamp.py, which commands have their line from, computes the same digest.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "hil/base/digest.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/structure/source_text.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;

struct Stamp {
  std::string line;
  std::vector<std::string> sources;
  std::string digest;
  bool is_old{};
};

std::vector<Stamp> stampsOf(const std::string& page) {
  static const std::regex kStamp(
      R"(\*Figures of commit [0-9a-f]{7,40} of \d{4}-\d\d-\d\d(?: and changes to it)?, (?:no seed|seeds? [^`]+), by `[^`]+`; of sources `([^`]+)`, ([0-9a-f]{12})(; older than their sources)?\.\*)");
  std::vector<Stamp> stamps;
  for (std::sregex_iterator it(page.begin(), page.end(), kStamp); it != std::sregex_iterator(); ++it) {
    Stamp stamp{it->str(), {}, (*it)[2].str(), (*it)[3].matched};
    std::istringstream names((*it)[1].str());
    for (std::string name; names >> name;) stamp.sources.push_back(name);
    stamps.push_back(stamp);
  }
  return stamps;
}

/// First 12 digits of the SHA-256 over names and bytes of all sources: files that are named, and code in
/// folders that are named.
std::string digestOfSources(const std::vector<std::string>& sources, const fs::path& root = sourceRoot()) {
  std::set<std::string> names;
  for (const std::string& source : sources) {
    if (!fs::is_directory(root / source)) {
      names.insert(source);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(root / source)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".cpp" || extension == ".h" || extension == ".c" || extension == ".py")
        names.insert(fs::relative(entry.path(), root).generic_string());
    }
  }
  std::string all;
  for (const std::string& name : names) all += name + '\n' + textOf(root / name) + '\n';
  return base::sha256(all).substr(0, 12);
}

/// Pages with figures that are dear to measure, and how many lines each has about them.
const std::map<std::string, std::size_t>& linesOfPages() {
  static const std::map<std::string, std::size_t> kLines{
      {"docs/explanation/belt-speeds.md", 1},
      {"docs/explanation/diagnosis.md", 1},
      {"docs/explanation/drawings-of-others.md", 2},
      {"docs/explanation/what-it-is-worth.md", 2},
      {"docs/how-to/calibrate-a-head.md", 2},
      {"docs/reference/papers.md", 1},
      {"tests/campaigns/RESULTS.md", 1},
      {"tests/ends/RESULTS.md", 1},
      {"tests/limits/RESULTS.md", 1},
      {"tests/mutation/RESULTS.md", 1},
      {"tests/mutation/RESULTS_SAMPLED.md", 1},
      {"tests/tamper/RESULTS.md", 1},
      {"tests/witness/RESULTS.md", 1},
      {"twin/VALIDATION.md", 1},
  };
  return kLines;
}

TEST(Figures, SayWhetherTheirSourcesHaveChanged) {
  for (const auto& [page, lines] : linesOfPages()) {
    const std::vector<Stamp> found = stampsOf(textOf(sourceRoot() / page));
    EXPECT_EQ(found.size(), lines) << page << " lacks a line about its figures, or nobody understands it";
    for (const Stamp& stamp : found) {
      for (const std::string& source : stamp.sources)
        ASSERT_TRUE(fs::exists(sourceRoot() / source)) << page << ": " << source;
      const std::string now = digestOfSources(stamp.sources);
      EXPECT_EQ(stamp.is_old, now != stamp.digest)
          << page << ": " << stamp.line << "\nthe digest of its sources is " << now
          << ": make the figures anew, or let `./bench figures` say whether they are older than their "
             "sources";
    }
  }
}

TEST(Figures, AreOnNoPageThatIsNotLookedAt) {
  for (const char* top : {"docs", "fixtures", "firmware_under_test", "hil", "tests", "twin"}) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      if (entry.path().extension() != ".md") continue;
      const std::string page = fs::relative(entry.path(), sourceRoot()).generic_string();
      const std::string text = textOf(entry.path());
      const auto known = linesOfPages().find(page);
      std::size_t meant = 0;
      for (std::size_t at = text.find("*Figures of"); at != std::string::npos;
           at = text.find("*Figures of", at + 1))
        ++meant;
      EXPECT_EQ(meant, known == linesOfPages().end() ? 0U : known->second) << page;
      if (text.find("<!-- Written by ./bench") != std::string::npos) {
        EXPECT_TRUE(known != linesOfPages().end()) << page << " does not say what its figures were made with";
      }
    }
  }
}

TEST(Figures, AreReadFromALineThatSaysAll) {
  const auto stamps = stampsOf(
      "text\n*Figures of commit 522e9d4 of 2026-11-23, seed 1, by `./bench gauge`; of sources `hil/vision "
      "hil/gauge`, 0123456789ab; older than their sources.*\n*Figures of commit 522e9d4: none.*\n"
      "*Figures of commit 522e9d4 of 2026-11-23 and changes to it, no seed, by `./bench mutate`; of sources "
      "`hil/vision`, ba9876543210.*\n");
  ASSERT_EQ(stamps.size(), 2U);
  EXPECT_EQ(stamps[0].sources, (std::vector<std::string>{"hil/vision", "hil/gauge"}));
  EXPECT_EQ(stamps[0].digest, "0123456789ab");
  EXPECT_TRUE(stamps[0].is_old);
  EXPECT_EQ(stamps[1].digest, "ba9876543210");
  EXPECT_FALSE(stamps[1].is_old);
}

TEST(Figures, AreNotReadFromALineThatLacksSomething) {
  const auto none = [](const std::string& commit_and_seed, const std::string& digest) {
    return stampsOf("*Figures of commit " + commit_and_seed +
                    ", by `./bench gauge`; of sources `hil/gauge`, " + digest + ".*\n")
        .empty();
  };
  EXPECT_FALSE(none("522e9d4 of 2026-11-23, seed 1", "0123456789ab"));
  EXPECT_TRUE(none("522e9d4, seed 1", "0123456789ab")) << "no date";
  EXPECT_TRUE(none("522e9d4 of 2026-11-23", "0123456789ab")) << "nothing about seeds";
  EXPECT_TRUE(none("unknown of unknown, seed 1", "0123456789ab")) << "no commit";
  EXPECT_TRUE(none("522e9d4 of 2026-11-23, seed 1", "0123456789a")) << "a digest that was cut";
}

TEST(Figures, DigestOfSourcesChangesWithThem) {
  EXPECT_EQ(digestOfSources({"hil/gauge"}), digestOfSources({"hil/gauge"}));
  EXPECT_NE(digestOfSources({"hil/gauge"}), digestOfSources({"hil/vision"}));
}

// The same files and the same digest are in tests/figures/stamp_test.py.
TEST(Figures, DigestOfSourcesIsTheOneOfTheOtherProgram) {
  const base::TempFolder tree;
  const std::map<std::string, std::string> files{{"a/one.cpp", "int one;\n"}, {"a/b/two.h", "int two;\n"},
                                                 {"a/b.py", "three = 3\n"},   {"a/notes.md", "no source\n"},
                                                 {"list.toml", "four = 4\n"}, {"ab/five.c", "int five;\n"}};
  for (const auto& [name, text] : files) {
    fs::create_directories((tree.path() / name).parent_path());
    std::ofstream(tree.path() / name) << text;
  }
  EXPECT_EQ(digestOfSources({"a", "list.toml"}, tree.path()), "92bb1ad0b846");
}

}  // namespace
}  // namespace kerfbench::test
