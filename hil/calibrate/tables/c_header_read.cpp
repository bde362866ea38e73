// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil/base/number_from.h"
#include "hil/calibrate/tables/c_header.h"
#include "hil/calibrate/tables/c_header_numbers.h"
#include "hil/calibrate/tables/table_text.h"

namespace kerfbench::calibrate {
namespace {

constexpr std::size_t kMostNumbers = AimGrid::kMostNodes * AimGrid::kMostNodes;

/// Takes a header line by line.
class Lines {
 public:
  explicit Lines(const std::string& name) : faults(name) {}

  void take(std::size_t number, std::string_view line) {
    if (array_ < kCHeaderArrays.size()) {
      takeNumbers(number, line);
    } else if (line.starts_with("#define ")) {
      takeConstant(line);
    } else if (line.starts_with("static const ")) {
      begin(number, line);
    }
  }
  /// @throws TableFileError if anything was wrong or is missing.
  CHeaderNumbers finish();

  TableFaults faults;

 private:
  void takeConstant(std::string_view line) {
    const auto words = wordsOf(line);
    if (words.size() != 3) return;
    for (const char* end : {"_COLUMNS", "_ROWS", "_UNIT_NM", "_HERMITE", "_OUTSIDE", "_SHA256"}) {
      if (words[1].ends_with(end)) constants_[end] = words[2];
    }
  }
  void begin(std::size_t number, std::string_view line);
  void takeNumbers(std::size_t number, std::string_view line);
  std::int64_t constant(const char* name, std::int64_t low, std::int64_t high);

  std::map<std::string, std::string, std::less<>> constants_;
  CHeaderNumbers numbers_;
  std::size_t array_{kCHeaderArrays.size()};  // The one that is being read; beyond the last: none.
  std::int64_t most_{};
};

void Lines::begin(std::size_t number, std::string_view line) {
  const std::string_view declared = line.substr(0, line.find('['));
  for (std::size_t i = 0; i < kCHeaderArrays.size(); ++i) {
    if (!declared.ends_with(kCHeaderArrays.at(i))) continue;
    if (!numbers_.arrays.at(i).empty()) faults.atLine(number, "this array was there already");
    most_ = declared.find("int16_t") != std::string_view::npos ? std::numeric_limits<std::int16_t>::max()
                                                               : std::numeric_limits<std::int32_t>::max();
    array_ = i;
    return;
  }
  faults.atLine(number, "an array that a correction does not have");
}

void Lines::takeNumbers(std::size_t number, std::string_view line) {
  if (line.starts_with('}')) {
    array_ = kCHeaderArrays.size();
    return;
  }
  if (line.ends_with(',')) line.remove_suffix(1);
  for (const std::string_view word : wordsOf(line, ',')) {
    const auto value = base::numberFrom<std::int64_t>(word);
    if (!value || *value > most_ || *value < -most_) {
      faults.atLine(number, fmt::format("a number is none, or beyond ±{}", most_));
    } else if (numbers_.arrays.at(array_).size() < kMostNumbers) {
      numbers_.arrays.at(array_).push_back(*value);
    }
  }
}

std::int64_t Lines::constant(const char* name, std::int64_t low, std::int64_t high) {
  const auto found = constants_.find(name);
  const auto value = found == constants_.end() ? std::nullopt : base::numberFrom<std::int64_t>(found->second);
  if (value && *value >= low && *value <= high) return *value;
  faults.ofFile(fmt::format("…{} must be defined as a whole number of {} to {}", name, low, high));
  return low;
}

CHeaderNumbers Lines::finish() {
  if (array_ < kCHeaderArrays.size())
    faults.ofFile(fmt::format("the file ends within …{}", kCHeaderArrays.at(array_)));
  const auto most = static_cast<std::int64_t>(AimGrid::kMostNodes);
  const auto columns = static_cast<std::size_t>(constant("_COLUMNS", 2, most));
  const auto rows = static_cast<std::size_t>(constant("_ROWS", 2, most));
  numbers_.unit_nm = constant("_UNIT_NM", 1, 1'000'000'000);
  numbers_.hermite = constant("_HERMITE", 0, 1);
  numbers_.outside = constant("_OUTSIDE", 0, 2);
  const std::array<std::size_t, 4> sizes{columns, rows, columns * rows, columns * rows};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (numbers_.arrays.at(i).size() == sizes.at(i)) continue;
    faults.ofFile(fmt::format("…{} has {} numbers, not {}", kCHeaderArrays.at(i),
                              numbers_.arrays.at(i).size(), sizes.at(i)));
  }
  faults.throwIfAny();
  if (constants_["_SHA256"] != "\"" + hashOf(numbers_) + "\"")
    faults.ofFile("…_SHA256 is not that of the numbers: they were changed");
  faults.throwIfAny();
  return std::move(numbers_);
}

}  // namespace

AimGrid parseCHeader(const std::string& text, const std::string& name) {
  Lines lines(name);
  forEachLine(text, [&](std::size_t number, std::string_view line) { lines.take(number, line); });
  const CHeaderNumbers numbers = lines.finish();
  std::array<std::vector<double>, 2> places;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (const std::int64_t place_nm : numbers.arrays.at(axis))
      places.at(axis).push_back(static_cast<double>(place_nm) / kNmPerMm);
  }
  const auto mm = [&](std::int64_t value) {
    return static_cast<double>(value) * static_cast<double>(numbers.unit_nm) / kNmPerMm;
  };
  std::vector<Eigen::Vector2d> d_mm;
  for (std::size_t i = 0; i < numbers.arrays[2].size(); ++i)
    d_mm.emplace_back(mm(numbers.arrays[2][i]), mm(numbers.arrays[3][i]));
  try {
    return {std::move(places[0]), std::move(places[1]), std::move(d_mm),
            numbers.hermite == 1 ? Between::kHermite : Between::kBilinear,
            static_cast<Outside>(numbers.outside)};
  } catch (const std::invalid_argument& e) {
    lines.faults.ofFile(e.what());
    lines.faults.throwIfAny();
    throw;
  }
}

}  // namespace kerfbench::calibrate
