// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/reference_keys.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/installation.h"
#include "hil/base/text.h"
#include "hil/desk/json_text.h"
#include "hil/desk/markdown.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Endings of keys and the units that they stand for; of several that fit the longest holds.
struct UnitEnding {
  std::string_view ending, unit;
};
constexpr auto kUnits = std::to_array<UnitEnding>({
    {"_mm", "mm"},
    {"_mm_s", "mm/s"},
    {"_mm_s2", "mm/s²"},
    {"_mm_s3", "mm/s³"},
    {"_um", "µm"},
    {"_s", "s"},
    {"_ms", "ms"},
    {"_us", "µs"},
    {"_per_s", "1/s"},
    {"_hz", "Hz"},
    {"_deg", "°"},
    {"_rad", "rad"},
    {"_mrad", "mrad"},
    {"_urad", "µrad"},
    {"_rad_s", "rad/s"},
    {"_rad_s2", "rad/s²"},
    {"_w", "W"},
    {"_mj", "mJ"},
    {"_j_mm", "J/mm"},
    {"_j_per_mm", "J/mm"},
    {"_j_mm2", "J/mm²"},
    {"_px", "px"},
    {"_ppm", "ppm"},
    {"_percent", "%"},
    {"_kg", "kg"},
    {"_kg_m2", "kg m²"},
    {"_n", "N"},
    {"_n_mm", "N/mm"},
    {"_n_s_m", "N s/m"},
    {"_n_m", "N m"},
    {"_n_m_rad", "N m/rad"},
    {"_n_m_s", "N m s"},
    {"_n_m_s_rad", "N m s/rad"},
    {"_1_m", "1/m"},
    {"_1_rad2", "1/rad²"},
    {"_1_rad4", "1/rad⁴"},
    {"_a", "A"},
    {"_v", "V"},
    {"_ohm", "Ω"},
    {"_mh", "mH"},
    {"_bytes", "bytes"},
    {"_days", "days"},
    {"_counts", "counts"},
    {"_pulses", "pulses"},
    {"_gray", "grey"},
    {"_gray_per_w", "grey/W"},
    {"_electrons", "electrons"},
    {"_mb_per_s", "MB/s"},
});

constexpr std::string_view kTo = " … ";

std::optional<double> numberFrom(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string> itemsIn(std::string_view cell) {
  std::vector<std::string> items;
  for (std::size_t from = 0; from <= cell.size();) {
    const std::size_t to = std::min(cell.find(", ", from), cell.size());
    std::string_view item = cell.substr(from, to - from);
    if (item.size() > 2 && item.front() == '`' && item.back() == '`') item = item.substr(1, item.size() - 2);
    items.emplace_back(item);
    from = to + 2;
  }
  return items;
}

bool isWord(std::string_view item) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789-_";
  return !item.empty() && item.find_first_not_of(kLetters) == std::string_view::npos;
}

/// Words that stand for a kind, alone in their cell.
std::optional<KeyRange> wholeCell(std::string_view cell) {
  if (cell == "true, false") return KeyRange{.kind = KeyKind::kFlag};
  if (cell == "file" || cell == "folder") return KeyRange{.kind = KeyKind::kFile};
  if (cell == "section") return KeyRange{.kind = KeyKind::kSection};
  if (cell == "list") return KeyRange{.kind = KeyKind::kList};
  if (cell == "file or section") return KeyRange{.kind = KeyKind::kFile, .or_section = true};
  for (const std::string_view text : {"text", "name", "day", "list as text"})
    if (cell == text) return KeyRange{.kind = KeyKind::kText};
  // A name in a library, or an address, as well as a file: any text.
  for (const std::string_view text : {"file, number or name", "file, tcp:HOST:PORT"})
    if (cell == text) return KeyRange{.kind = KeyKind::kText, .or_file = true};
  return std::nullopt;
}

std::vector<std::string> cellsOf(std::string_view row) {
  std::vector<std::string> cells;
  for (std::size_t from = row.find('|'); from != std::string_view::npos;) {
    const std::size_t to = row.find('|', from + 1);
    if (to == std::string_view::npos) break;
    cells.emplace_back(base::trimmed(row.substr(from + 1, to - from - 1)));
    from = to;
  }
  return cells;
}

std::vector<std::string> inBackticks(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t begin = text.find('`'); begin != std::string_view::npos;) {
    const std::size_t end = text.find('`', begin + 1);
    if (end == std::string_view::npos) break;
    words.emplace_back(text.substr(begin + 1, end - begin - 1));
    begin = text.find('`', end + 1);
  }
  return words;
}

ReferenceKey keyFrom(const std::string& name, const std::vector<std::string>& cells, KeyRange range) {
  ReferenceKey key{.key = name,
                   .range = std::move(range),
                   .range_text = cells[1],
                   .fallback = {},
                   .required = {},
                   .meaning = cells[3]};
  if (key.range.kind == KeyKind::kNumber) {
    key.count = numbersIn(key.meaning);
    if (key.count > 1) key.range.kind = KeyKind::kNumbers;
  }
  (cells[2].starts_with("required") ? key.required : key.fallback) = cells[2];
  return key;
}

/// Reads a page line by line.
class PageReader {
 public:
  std::vector<ReferenceSection> read(const std::string& text) {
    for (std::size_t from = 0; from < text.size();) {
      const std::size_t to = std::min(text.find('\n', from), text.size());
      readLine(std::string_view(text).substr(from, to - from));
      from = to + 1;
    }
    if (!faults_.empty())
      throw base::InputError(fmt::format("rows of the reference that this program does not understand: {}",
                                         fmt::join(faults_, "; ")));
    std::erase_if(sections_, [](const ReferenceSection& section) { return section.keys.empty(); });
    return std::move(sections_);
  }

 private:
  void readLine(std::string_view line) {
    if (line.starts_with("## ")) {
      sections_.push_back({.title = std::string(line.substr(3)), .prefixes = {""}});
      in_table_ = false;
    } else if (sections_.empty()) {
      return;
    } else if (line.starts_with("Prefix: ")) {
      begin(inBackticks(line));
    } else if (line.starts_with("| key |")) {
      in_table_ = true;
    } else if (line.starts_with("|")) {
      if (in_table_ && line.starts_with("| `")) readRow(line);
    } else {
      in_table_ = false;
      if (sections_.back().keys.empty()) sections_.back().text += std::string(line) + "\n";
    }
  }

  /// A second prefix under one heading begins a section of its own.
  void begin(std::vector<std::string> prefixes) {
    if (!sections_.back().keys.empty()) sections_.push_back({.title = sections_.back().title});
    sections_.back().prefixes = std::move(prefixes);
  }

  void readRow(std::string_view line) {
    const std::vector<std::string> cells = cellsOf(line);
    const std::optional<KeyRange> range = cells.size() == 4 ? keyRangeFrom(cells[1]) : std::nullopt;
    for (const std::string& name : inBackticks(cells.empty() ? line : std::string_view(cells[0]))) {
      if (range) {
        sections_.back().keys.push_back(keyFrom(name, cells, *range));
      } else {
        faults_.push_back(sections_.back().prefixes.front() + name);
      }
    }
  }

  std::vector<ReferenceSection> sections_;
  std::vector<std::string> faults_;
  bool in_table_{};
};

json jsonOf(const ReferenceKey& key, const std::string& prefix) {
  const auto orNull = [](const std::optional<double>& value) { return value ? json(*value) : json(); };
  return {{"key", key.key},
          {"path", prefix + key.key},
          {"range", key.range_text},
          {"kind", nameOf(key.range.kind)},
          {"count", key.count},
          {"least", orNull(key.range.least)},
          {"most", orNull(key.range.most)},
          {"choices", key.range.choices},
          {"or_file", key.range.or_file},
          {"or_list", key.range.or_list},
          {"or_section", key.range.or_section},
          {"default", key.fallback},
          {"required", key.required},
          {"unit", unitOf(key.key)},
          {"help_html", markdownInline(key.meaning)}};
}

}  // namespace

std::string_view nameOf(KeyKind kind) {
  constexpr std::array<std::string_view, 8> kNames{"number", "numbers", "choice", "flag",
                                                   "file",   "text",    "list",   "section"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::optional<KeyRange> keyRangeFrom(std::string_view cell) {
  if (const auto known = wholeCell(cell)) return known;
  if (const auto at = cell.find(kTo); at != std::string_view::npos) {
    const auto least = numberFrom(cell.substr(0, at));
    const auto most = numberFrom(cell.substr(at + kTo.size()));
    if (!least || !most || *least > *most) return std::nullopt;
    return KeyRange{.kind = KeyKind::kNumber, .least = least, .most = most};
  }
  if (const auto only = numberFrom(cell))
    return KeyRange{.kind = KeyKind::kNumber, .least = only, .most = only};
  const std::vector<std::string> items = itemsIn(cell);
  KeyRange range{.kind = KeyKind::kChoice};
  for (const std::string& item : items) {
    if (!isWord(item)) return std::nullopt;
    if (item == "list") {
      range.or_list = true;
    } else if (item == "file") {
      range.or_file = true;
    } else {
      range.choices.push_back(item);
    }
  }
  // A single word that is none of the known ones is a kind that this program does not know.
  if (items.size() < 2) return std::nullopt;
  return range;
}

std::size_t numbersIn(std::string_view meaning) {
  constexpr std::array<std::string_view, 4> kWords{"Two", "Three", "Four", "Five"};
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (!meaning.starts_with(kWords.at(i))) continue;
    const std::string_view rest = meaning.substr(kWords.at(i).size());
    if (rest.starts_with(':') || rest.starts_with('.') || rest.starts_with(" numbers") ||
        rest.starts_with(" whole numbers"))
      return i + 2;
  }
  return meaning.find(": two numbers") != std::string_view::npos ? 2 : 1;
}

std::string unitOf(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  const std::string_view last = dot == std::string_view::npos ? key : key.substr(dot + 1);
  UnitEnding best{};
  for (const UnitEnding& unit : kUnits)
    if (last.ends_with(unit.ending) && unit.ending.size() > best.ending.size()) best = unit;
  return std::string(best.unit);
}

std::vector<ReferenceSection> referenceSections(const std::string& page_text) {
  return PageReader().read(page_text);
}

fs::path referencePage(const std::string& page, const fs::path& bin_dir) {
  if (page != "scenario" && page != "machine")
    throw base::InputError(
        fmt::format("{} is no page of the reference: scenario, machine", base::inQuotes(page)));
  fs::path file = base::referencePages(bin_dir) / (page + ".md");
  if (!fs::is_regular_file(file)) throw base::InputError(fmt::format("there is no {}", file.string()));
  return file;
}

std::string referenceJson(const std::string& page, const fs::path& bin_dir) {
  const fs::path file = referencePage(page, bin_dir);
  const auto text = base::fileContent(file);
  if (!text) throw base::InputError("cannot read " + file.string());
  json sections = json::array();
  for (const ReferenceSection& section : referenceSections(*text)) {
    json keys = json::array();
    for (const ReferenceKey& key : section.keys) keys.push_back(jsonOf(key, section.prefixes.front()));
    sections.push_back({{"title", section.title},
                        {"help_html", markdownBlocks(section.text)},
                        {"prefixes", section.prefixes},
                        {"keys", std::move(keys)}});
  }
  return jsonText({{"sections", std::move(sections)}});
}

}  // namespace kerfbench::desk
