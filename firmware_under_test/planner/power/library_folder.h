// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/power/library.h"

namespace kerfbench::planner {

enum class EntryKind { kMaterial, kLaser };
/// "material" or "laser", as files have it.
const char* nameOf(EntryKind kind);

/// A file of a library, whether it can be used or not.
struct LibraryEntry {
  std::filesystem::path file;
  std::optional<EntryKind> kind;  ///< None if the file does not say, or cannot be read.
  std::optional<int> number;
  std::string name;
  std::string number_place, name_place;  ///< "file:line" of the keys.
  std::optional<Material> material;      ///< The content, of a material that can be used.
  std::optional<LaserTube> laser;        ///< The content, of a laser that can be used.
  /// What is wrong or missing, "file:line: key: what": a library wants a number and a source, a job does not.
  std::vector<std::string> faults;
};

/// A folder of materials and lasers (the database of Wang, Li, Chen 2010), a YAML file for each. Numbers are
/// stable ids, unique among the materials and among the lasers; names are unique as well, whatever their
/// case.
class LibraryFolder {
 public:
  /// Reads all *.yaml and *.yml, by name. @throws PowerError if there is no such folder; faults of files are
  /// kept.
  explicit LibraryFolder(const std::filesystem::path& folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Materials and then lasers by number; then what has none.
  [[nodiscard]] const std::vector<LibraryEntry>& entries() const { return entries_; }
  /// Everything wrong, file by file: curves that do not rise, missing units, sources and numbers, values out
  /// of range, and numbers and names that are there twice, with both places.
  [[nodiscard]] std::vector<std::string> faults() const;

  /// File of the entry with a number ("3") or name. @throws PowerError that says what is there; if it is
  /// there twice, with both places.
  [[nodiscard]] std::filesystem::path fileOf(EntryKind kind, const std::string& wanted) const;
  /// Materials that can be cut so deep, "2 (board) to 0.4 mm"; empty if there is none.
  [[nodiscard]] std::string materialsFor(double depth_mm) const;

 private:
  std::filesystem::path folder_;
  std::vector<LibraryEntry> entries_;
};

/// Whether a user means an entry of a library, and no file: a file ends in .yaml or .yml, or has a slash.
bool isLibraryName(const std::string& wanted);

/// Table of a library: number, kind, name, range, file. One line for an entry.
std::string libraryTable(const LibraryFolder& library);
/// All that an entry says: number, file, source, units, range, points.
std::string entryPage(const LibraryEntry& entry);

}  // namespace kerfbench::planner
