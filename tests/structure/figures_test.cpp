// SPDX-License-Identifier: Apache-2.0
// Figures on the pages of the documents against the sources that they were measured with. A line
//
//     *Figures of commit 0123abc, seed 1, by `command`; of sources `hil/vision hil/gauge`, 0123456789ab.*
//
// states what the paragraph or table before it was made with; the last word is the digest of these folders
// then. When the sources change, the line must say so: "; older than their sources.*" in place of ".*".
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "hil/base/digest.h"
#include "tests/structure/source_text.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;

struct Stamp {
  std::string line;
  std::vector<std::string> folders;
  std::string digest;
  bool is_old{};
};

std::vector<Stamp> stampsOf(const std::string& page) {
  static const std::regex kStamp(
      R"(\*Figures of commit [0-9a-f]{7,40}, (?:seed|seeds) [^`]+, by `[^`]+`; of sources `([^`]+)`, ([0-9a-f]{12})(; older than their sources)?\.\*)");
  std::vector<Stamp> stamps;
  for (std::sregex_iterator it(page.begin(), page.end(), kStamp); it != std::sregex_iterator(); ++it) {
    Stamp stamp{it->str(), {}, (*it)[2].str(), (*it)[3].matched};
    std::istringstream names((*it)[1].str());
    for (std::string name; names >> name;) stamp.folders.push_back(name);
    stamps.push_back(stamp);
  }
  return stamps;
}

/// First 12 digits of the SHA-256 over names and bytes of all sources in the folders.
std::string digestOfSources(const std::vector<std::string>& folders) {
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".cpp" || extension == ".h" || extension == ".c")
        names.push_back(fs::relative(entry.path(), sourceRoot()).generic_string());
    }
  }
  std::ranges::sort(names);
  std::string all;
  for (const std::string& name : names) all += name + '\n' + textOf(sourceRoot() / name) + '\n';
  return base::sha256(all).substr(0, 12);
}

TEST(Figures, SayWhetherTheirSourcesHaveChanged) {
  int stamps = 0;
  for (const char* page : {"docs/explanation/what-it-is-worth.md", "docs/how-to/calibrate-a-head.md"}) {
    const std::string text = textOf(sourceRoot() / page);
    const std::vector<Stamp> found = stampsOf(text);
    std::size_t meant = 0;
    for (std::size_t at = text.find("*Figures of"); at != std::string::npos;
         at = text.find("*Figures of", at + 1))
      ++meant;
    EXPECT_EQ(found.size(), meant) << page << " has a line about its figures that nobody understands";
    for (const Stamp& stamp : found) {
      ++stamps;
      for (const std::string& folder : stamp.folders)
        ASSERT_TRUE(fs::is_directory(sourceRoot() / folder)) << page << ": " << folder;
      const std::string now = digestOfSources(stamp.folders);
      EXPECT_EQ(stamp.is_old, now != stamp.digest)
          << page << ": " << stamp.line << "\nthe digest of its sources is " << now
          << ": make the figures anew and put this in their line, or let it say that they are older than "
             "their sources";
    }
  }
  EXPECT_GE(stamps, 3);
}

TEST(Figures, AreReadFromALineThatSaysAll) {
  const auto stamps = stampsOf(
      "text\n*Figures of commit 522e9d4, seed 1, by `./bench gauge`; of sources `hil/vision hil/gauge`, "
      "0123456789ab; older than their sources.*\n*Figures of commit 522e9d4: none.*\n");
  ASSERT_EQ(stamps.size(), 1U);
  EXPECT_EQ(stamps[0].folders, (std::vector<std::string>{"hil/vision", "hil/gauge"}));
  EXPECT_EQ(stamps[0].digest, "0123456789ab");
  EXPECT_TRUE(stamps[0].is_old);
}

TEST(Figures, DigestOfSourcesChangesWithThem) {
  EXPECT_EQ(digestOfSources({"hil/gauge"}), digestOfSources({"hil/gauge"}));
  EXPECT_NE(digestOfSources({"hil/gauge"}), digestOfSources({"hil/vision"}));
}

}  // namespace
}  // namespace kerfbench::test
