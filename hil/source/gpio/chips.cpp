// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/chips.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include "hil/base/number_from.h"

namespace kerfbench::source {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "gpiochip";

}  // namespace

GpioChipList listChips(const fs::path& dev) {
  std::vector<std::pair<unsigned, fs::path>> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(dev, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix)) continue;
    if (const auto number = base::numberFrom<unsigned>(std::string_view(name).substr(kPrefix.size())))
      found.emplace_back(*number, entry.path());
  }
  std::ranges::sort(found);
  GpioChipList list;
  if (error) list.faults.push_back(fmt::format("{}: {}", dev.string(), error.message()));
  for (const auto& [number, path] : found) {
    try {
      list.chips.push_back(readChip(path));
    } catch (const GpioError& e) {
      list.faults.emplace_back(e.what());
    }
  }
  return list;
}

const GpioChipInfo& findChip(const GpioChipList& list, const std::string& which) {
  std::vector<const GpioChipInfo*> found;
  for (const GpioChipInfo& chip : list.chips) {
    if (which == chip.path.string() || which == chip.name) return chip;
    if (which == chip.label) found.push_back(&chip);
  }
  if (found.size() == 1) return *found.front();
  if (found.size() > 1) {
    throw GpioError(fmt::format("{} chips have the label '{}': name one by its path, such as {}",
                                found.size(), which, found.front()->path.string()));
  }
  std::string words = fmt::format("there is no gpiochip '{}'; ", which);
  if (list.chips.empty()) words += "this computer has none that can be read";
  for (const GpioChipInfo& chip : list.chips)
    words += fmt::format("{}{} ({})", &chip == &list.chips.front() ? "there are " : ", ", chip.path.string(),
                         chip.label);
  for (const std::string& fault : list.faults) words += "\n" + fault;
  throw GpioError(words);
}

const GpioLineInfo& findLine(const GpioChipInfo& chip, const std::string& which) {
  if (const auto offset = base::numberFrom<std::uint32_t>(which)) {
    const auto found = std::ranges::find(chip.lines, *offset, &GpioLineInfo::offset);
    if (found != chip.lines.end()) return *found;
    throw GpioError(
        fmt::format("{} has no line {}: it has {}", chip.path.string(), which, chip.lines.size()));
  }
  const auto named = [&](const GpioLineInfo& line) { return line.name == which; };
  const auto found = std::ranges::find_if(chip.lines, named);
  if (which.empty() || found == chip.lines.end())
    throw GpioError(fmt::format("{} has no line of the name '{}'", chip.path.string(), which));
  if (std::find_if(found + 1, chip.lines.end(), named) != chip.lines.end())
    throw GpioError(
        fmt::format("{} has several lines of the name '{}': use its number", chip.path.string(), which));
  return *found;
}

}  // namespace kerfbench::source
