// SPDX-License-Identifier: Apache-2.0
// Measures the accuracy of the twin and writes it down. Exit: 0 all claims hold, 1 one does not, 2 it broke.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "tests/validation/studies.h"
#include "tests/validation/support/page.h"

namespace kerfbench::validation {
namespace {

int validate(int argc, char** argv) {
  CLI::App app{"Measures the twin against closed forms and an integrator of its own."};
  Context context;
  bool quick = false;
  std::string page;
  std::string draft;
  std::string made_with;
  std::vector<std::string> only;
  std::vector<std::string> names;
  for (const Study& study : studies()) names.emplace_back(study.name);
  context.source_dir = KERFBENCH_SOURCE_DIR;
  app.add_flag("--quick", quick, "Smaller sweeps, no study that needs a clock");
  CLI::Option* made_with_option =
      app.add_option("--made-with", made_with, "Line of the page that says what its figures were made with");
  app.add_option("--page", page, "Write the page here, and its pictures into validation/ beside it")
      ->needs(made_with_option);
  app.add_option("--draft", draft, "Write a page of what was run, for looking at it");
  app.add_option("--only", only, "Only these studies")->check(CLI::IsMember(names));
  CLI11_PARSE(app, argc, argv);
  if (quick) context.effort = Effort::kQuick;
  if (!page.empty() && (quick || !only.empty())) {
    fmt::print(stderr, "a page is whole: --page goes neither with --quick nor with --only\n");
    return 64;
  }

  std::vector<Chapter> chapters;
  for (const Study& study : studies()) {
    if (!only.empty() && std::ranges::find(only, study.name) == only.end()) continue;
    if (quick && study.clock) continue;
    chapters.push_back({study.run(context), study.clock});
    fmt::print("{}", claimLines(chapters.back().section));
    std::fflush(stdout);
  }
  if (!page.empty()) writePage(page, chapters, made_with);
  if (!draft.empty()) writePage(draft, chapters, {});
  const bool pass =
      !chapters.empty() && std::ranges::all_of(chapters, [](const auto& c) { return c.section.pass(); });
  fmt::print("{}\n", pass ? "PASS" : "FAIL");
  return pass ? 0 : 1;
}

}  // namespace
}  // namespace kerfbench::validation

int main(int argc, char** argv) {
  try {
    return kerfbench::validation::validate(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "kerfbench-validation: {}\n", e.what());
    return 2;
  }
}
