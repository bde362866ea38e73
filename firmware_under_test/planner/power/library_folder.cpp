// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/library_folder.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/text.h"
#include "hil/base/yaml_reader.h"

namespace kerfbench::planner {
namespace {

namespace fs = std::filesystem;

void addLines(const std::string& text, std::vector<std::string>& lines) {
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    if (to > from) lines.push_back(text.substr(from, to - from));
    from = to + 1;
  }
}

/// What can be told of a file without its points: also of one that is faulty.
void readHead(LibraryEntry& entry) {
  base::YamlReader file = base::YamlReader::openFile(entry.file);
  const std::string kind = file.text("kind", "");
  if (kind == "material") entry.kind = EntryKind::kMaterial;
  if (kind == "laser") entry.kind = EntryKind::kLaser;
  entry.name = file.text("name", "");
  entry.number_place = file.placeOf("number");
  entry.name_place = file.placeOf("name");
  if (!entry.kind) {
    entry.faults.push_back(
        fmt::format("{}: kind: '{}' is neither material nor laser", file.placeOf("kind"), kind));
  }
  if (file.has("number")) entry.number = static_cast<int>(file.integer("number", {.fallback = 0.0}));
  if (!entry.number) {
    entry.faults.push_back(fmt::format(
        "{}: number: is missing; the entry of a library has one that never changes", entry.number_place));
  }
  if (base::trimmed(file.text("source", "")).empty()) {
    entry.faults.push_back(
        fmt::format("{}: source: is missing; who measured the points, and how?", file.placeOf("source")));
  }
}

LibraryEntry readEntry(const fs::path& path) {
  LibraryEntry entry;
  entry.file = path;
  try {
    readHead(entry);
    if (entry.kind == EntryKind::kMaterial) entry.material = readMaterial(path);
    if (entry.kind == EntryKind::kLaser) entry.laser = readLaser(path);
  } catch (const base::ConfigError& error) {
    addLines(error.what(), entry.faults);
  } catch (const PowerError& error) {
    addLines(error.what(), entry.faults);
  }
  return entry;
}

bool precedes(const LibraryEntry& a, const LibraryEntry& b) {
  static constexpr int kLast = 1 << 30;
  const auto rank = [](const LibraryEntry& entry) {
    return std::tuple(entry.kind ? static_cast<int>(*entry.kind) : kLast, entry.number.value_or(kLast),
                      entry.file);
  };
  return rank(a) < rank(b);
}

bool isDigits(const std::string& text) {
  return !text.empty() && text.size() < 10 && text.find_first_not_of("0123456789") == std::string::npos;
}

/// "3 (mild steel)"
std::string labelOf(const LibraryEntry& entry) {
  return fmt::format("{} ({})", entry.number ? std::to_string(*entry.number) : "without a number",
                     entry.name);
}

/// Ranges of a curve's two columns.
std::string rangeOf(const LibraryEntry& entry) {
  if (!entry.material && !entry.laser) return "cannot be used";
  const Curve& curve = entry.material ? entry.material->depth : entry.laser->power;
  return fmt::format("{:g} … {:g} {} give {:g} … {:g} {}", curve.least().x, curve.greatest().x,
                     entry.material ? "J/mm2" : entry.laser->control_unit, curve.least().y,
                     curve.greatest().y, entry.material ? "mm" : "W");
}

}  // namespace

const char* nameOf(EntryKind kind) { return kind == EntryKind::kMaterial ? "material" : "laser"; }

LibraryFolder::LibraryFolder(const fs::path& folder) : folder_(folder) {
  if (!fs::is_directory(folder)) throw PowerError(folder.string() + ": is no folder of materials and lasers");
  std::vector<fs::path> files;
  for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
    const std::string ending = file.path().extension().string();
    if (file.is_regular_file() && (ending == ".yaml" || ending == ".yml")) files.push_back(file.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) entries_.push_back(readEntry(file));
  std::sort(entries_.begin(), entries_.end(), precedes);
}

std::vector<std::string> LibraryFolder::faults() const {
  std::vector<std::string> all;
  std::map<std::pair<EntryKind, std::string>, const LibraryEntry*> names;
  std::map<std::pair<EntryKind, int>, const LibraryEntry*> numbers;
  if (entries_.empty()) all.push_back(folder_.string() + ": holds no entry (*.yaml)");
  for (const LibraryEntry& entry : entries_) {
    all.insert(all.end(), entry.faults.begin(), entry.faults.end());
    if (!entry.kind) continue;
    if (entry.number) {
      const auto& first = numbers.emplace(std::pair(*entry.kind, *entry.number), &entry).first->second;
      if (first != &entry)
        all.push_back(fmt::format("{}: number: {} is that of {} already", entry.number_place, *entry.number,
                                  first->number_place));
    }
    const std::string name = base::lowered(base::trimmed(entry.name));
    const auto& first = names.emplace(std::pair(*entry.kind, name), &entry).first->second;
    if (first != &entry && !name.empty())
      all.push_back(fmt::format("{}: name: '{}' is that of {} already", entry.name_place, entry.name,
                                first->name_place));
  }
  return all;
}

fs::path LibraryFolder::fileOf(EntryKind kind, const std::string& wanted) const {
  const std::string name = base::lowered(base::trimmed(wanted));
  std::vector<std::string> there;
  std::vector<const LibraryEntry*> found;
  for (const LibraryEntry& entry : entries_) {
    if (entry.kind != kind) continue;
    there.push_back(labelOf(entry));
    const bool is_it = isDigits(name) ? entry.number && std::to_string(*entry.number) == name
                                      : base::lowered(base::trimmed(entry.name)) == name;
    if (is_it) found.push_back(&entry);
  }
  if (found.empty()) {
    throw PowerError(fmt::format("{}: there is no {} '{}'; there are {}", folder_.string(), nameOf(kind),
                                 wanted, there.empty() ? "none" : fmt::format("{}", fmt::join(there, ", "))));
  }
  if (found.size() > 1) {
    throw PowerError(fmt::format("{}: {} '{}' is there twice: {} and {}", folder_.string(), nameOf(kind),
                                 wanted, found[0]->file.string(), found[1]->file.string()));
  }
  return found.front()->file;
}

std::string LibraryFolder::materialsFor(double depth_mm) const {
  std::vector<std::string> deep;
  for (const LibraryEntry& entry : entries_) {
    if (entry.material && entry.material->depth.greatest().y >= depth_mm)
      deep.push_back(fmt::format("{} to {:g} mm", labelOf(entry), entry.material->depth.greatest().y));
  }
  return fmt::format("{}", fmt::join(deep, ", "));
}

bool isLibraryName(const std::string& wanted) {
  const std::string ending = base::lowered(fs::path(wanted).extension().string());
  return !wanted.empty() && ending != ".yaml" && ending != ".yml" && wanted.find('/') == std::string::npos;
}

std::string libraryTable(const LibraryFolder& library) {
  std::string text;
  for (const LibraryEntry& entry : library.entries()) {
    text += fmt::format("{:8} {:>4}  {:20}  {:40}  {}\n", entry.kind ? nameOf(*entry.kind) : "?",
                        entry.number ? std::to_string(*entry.number) : "-", entry.name, rangeOf(entry),
                        entry.file.filename().string());
  }
  return text;
}

std::string entryPage(const LibraryEntry& entry) {
  std::string text = fmt::format("{} {}\n  file    {}\n", entry.kind ? nameOf(*entry.kind) : "entry",
                                 labelOf(entry), entry.file.string());
  for (const std::string& fault : entry.faults) text += "  fault   " + fault + "\n";
  if (!entry.material && !entry.laser) return text;
  text += fmt::format("  source  {}\n  range   {}\n",
                      entry.material ? entry.material->source : entry.laser->source, rangeOf(entry));
  if (entry.laser) {
    const LaserTube& laser = *entry.laser;
    text += fmt::format("  used    {:g} … {:g} W; {:g} {} at full duty\n", laser.least_w, laser.most_w,
                        laser.full_control, laser.control_unit);
  }
  const std::string x_name = entry.material ? "P_ua J/mm2" : "u " + entry.laser->control_unit;
  text += fmt::format("  {:>12}{:>12}\n", x_name, entry.material ? "depth mm" : "P_out W");
  for (const Curve::Point& point : (entry.material ? entry.material->depth : entry.laser->power).points())
    text += fmt::format("  {:12g}{:12g}\n", point.x, point.y);
  return text;
}

}  // namespace kerfbench::planner
