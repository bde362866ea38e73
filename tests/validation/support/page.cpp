// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/page.h"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"

namespace kerfbench::validation {
namespace {

constexpr const char* kHead =
    "<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
    "<!-- Written by ./bench validate. Do not edit: change the study in tests/validation. -->\n"
    "# What the twin is worth\n\n"
    "`./bench validate` measures every figure of this page anew, writes the page, and fails if a claim does "
    "not hold. The limit\nof each claim stands beside what was measured. The truth that the twin is held "
    "against is a closed form or an integrator\nof its own (`tests/validation/support`): equations of motion "
    "written by hand, steps of 0.2 µs, no line shared with `twin/`.\n\n";

const char* sign(Claim::Relation relation) { return relation == Claim::Relation::kAtMost ? "≤" : "≥"; }

std::vector<std::string> row(const Claim& claim) {
  return {claim.says, fmt::format("{} {}", figureText(claim.measured, claim.floor), claim.unit),
          fmt::format("{} {:g} {}", sign(claim.relation), claim.limit, claim.unit),
          claim.holds() ? "pass" : "**FAIL**"};
}

std::string chapterText(int number, const Section& section) {
  std::string text = fmt::format("## {}. {}\n\n{}\n", number, section.title, section.markdown);
  std::vector<std::vector<std::string>> rows;
  for (const Claim& claim : section.claims) rows.push_back(row(claim));
  text += markdownTable({"claim", "measured", "limit", ""}, rows);
  for (const Figure& figure : section.figures) {
    text += fmt::format("![{0}](validation/{1}.svg)\n*{0}*\n\n", figure.says, figure.name);
  }
  return text;
}

std::string summary(const std::vector<Chapter>& chapters) {
  std::vector<std::vector<std::string>> rows;
  int number = 0;
  for (const Chapter& chapter : chapters) {
    const auto& claims = chapter.section.claims;
    rows.push_back({fmt::format("{}. {}", ++number, chapter.section.title),
                    fmt::format("{} of {}", std::ranges::count_if(claims, &Claim::holds), claims.size()),
                    chapter.section.pass() ? "pass" : "**FAIL**"});
  }
  return markdownTable({"study", "claims that hold", ""}, rows);
}

}  // namespace

std::string claimLines(const Section& section) {
  std::string text = fmt::format("{}  {}\n", section.pass() ? "pass" : "FAIL", section.title);
  for (const Claim& claim : section.claims) {
    const auto cells = row(claim);
    text += fmt::format("  {}  {}: {} ({})\n", claim.holds() ? "pass" : "FAIL", cells[0], cells[1], cells[2]);
  }
  return text;
}

void writePage(const std::filesystem::path& page, const std::vector<Chapter>& chapters,
               const std::string& made_with) {
  std::vector<Chapter> ordered = chapters;
  std::stable_partition(ordered.begin(), ordered.end(),
                        [](const Chapter& chapter) { return !chapter.clock; });
  std::string text = kHead + (made_with.empty() ? "" : made_with + "\n\n") + summary(ordered);
  int number = 0;
  bool clock_begun = false;
  const auto folder = page.parent_path() / "validation";
  std::filesystem::create_directories(folder);
  std::set<std::filesystem::path> shown;
  for (const Chapter& chapter : ordered) {
    if (chapter.clock && !clock_begun) {
      text += "# Measured with a clock\n\nThese figures are of one computer and differ from run to run.\n\n";
      clock_begun = true;
    }
    text += chapterText(++number, chapter.section);
    for (const Figure& figure : chapter.section.figures) {
      const auto file = folder / (figure.name + ".svg");
      base::writeFileAtomically(file, figure.svg);
      shown.insert(file);
    }
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".svg" && !shown.contains(entry.path()))
      std::filesystem::remove(entry.path());
  }
  base::writeFileAtomically(page, text);
}

}  // namespace kerfbench::validation
