// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_library.h"

#include <filesystem>
#include <set>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/power/library_folder.h"
#include "hil/base/installation.h"
#include "hil/base/terminal.h"

namespace kerfbench::planner {

namespace fs = std::filesystem;

struct LibraryCommand::Options {
  std::string library{shippedLibrary()};
  std::string entry;
};

std::string shippedLibrary() {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return {};
  const fs::path folder = base::shippedData(program.parent_path()) / "power";
  return fs::is_directory(folder, failed) ? folder.string() : std::string();
}

LibraryCommand::LibraryCommand(CLI::App& app) : options_(std::make_shared<Options>()) {
  CLI::App* library = app.add_subcommand(
      "library", "The materials and lasers for --material and --laser: a folder with a YAML file for each");
  library->require_subcommand(1);
  const auto add = [&](const char* name, const char* help) {
    CLI::App* sub = library->add_subcommand(name, help);
    sub->add_option("--library", options_->library, "The folder, by default the one that is shipped");
    return sub;
  };
  list_ = add("list", "List number, kind, name, range and file of each entry");
  show_ = add("show", "Print source, units, range and points of the entries with a number or name");
  show_->add_option("ENTRY", options_->entry, "Number or name")->required();
  check_ = add("check",
               "Find curves that do not rise, missing units, sources and numbers, values out of range, and "
               "numbers and names that are there twice");
}

bool LibraryCommand::run() const {
  if (!list_->parsed() && !show_->parsed() && !check_->parsed()) return false;
  if (options_->library.empty())
    throw PowerError("no library is shipped with this program: give a --library");
  const LibraryFolder library(options_->library);
  if (list_->parsed()) base::toTerminal(stdout, libraryTable(library));
  if (show_->parsed()) {
    std::set<fs::path> wanted;
    std::string refusal;
    for (const EntryKind kind : {EntryKind::kMaterial, EntryKind::kLaser}) {
      try {
        wanted.insert(library.fileOf(kind, options_->entry));
      } catch (const PowerError& error) {
        refusal += (refusal.empty() ? "" : "\n") + std::string(error.what());
      }
    }
    if (wanted.empty()) throw PowerError(refusal);
    for (const LibraryEntry& entry : library.entries())
      if (wanted.count(entry.file) > 0) base::toTerminal(stdout, entryPage(entry));
  }
  if (check_->parsed()) {
    const std::vector<std::string> faults = library.faults();
    if (!faults.empty()) throw PowerError(fmt::format("{}", fmt::join(faults, "\n")));
    base::toTerminal(
        stdout, fmt::format("{}: {} entries, nothing wrong\n", options_->library, library.entries().size()));
  }
  return true;
}

}  // namespace kerfbench::planner
