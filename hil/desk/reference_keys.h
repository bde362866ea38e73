// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kerfbench::desk {

/// How a key's value is entered.
enum class KeyKind { kNumber, kNumbers, kChoice, kFlag, kFile, kText, kList, kSection };
/// "number", "numbers", "choice", "flag", "file", "text", "list" or "section".
std::string_view nameOf(KeyKind kind);

/// What the cell `range` of a key says.
struct KeyRange {
  KeyKind kind{};
  std::optional<double> least, most;        ///< Bounds of a number, or of each of several.
  std::vector<std::string> choices;         ///< Words that may stand there.
  bool or_file{}, or_list{}, or_section{};  ///< What else may stand there.
};
/// Nothing for a cell that this program does not understand. Several numbers are told by the meaning alone.
std::optional<KeyRange> keyRangeFrom(std::string_view cell);

/// How many numbers a key takes by the words that begin its meaning ("Two: …", "… two numbers"); 1 where
/// they say nothing.
std::size_t numbersIn(std::string_view meaning);

/// Unit of a key by its ending, "mm/s" of "belt.speed_mm_s"; empty: none.
std::string unitOf(std::string_view key);

/// A key as docs/reference describes it.
struct ReferenceKey {
  std::string key;  ///< As in the table: "speed_mm_s", "marks[].x_mm".
  KeyRange range;
  std::string range_text;  ///< The cell itself.
  std::size_t count{1};    ///< How many numbers; 1 for all other kinds.
  std::string fallback;    ///< Default as the page has it; empty: none, the key is required.
  std::string required;    ///< "", "required", or with its condition: "required for `gpio`".
  std::string meaning;     ///< Markdown.
};

struct ReferenceSection {
  std::string title;                  ///< Heading of the page.
  std::string text;                   ///< Markdown between the heading and the table.
  std::vector<std::string> prefixes;  ///< Before each key: "belt."; several for sections that are alike.
  std::vector<ReferenceKey> keys;
};

/// Reads the tables `key | range | default | meaning` of a page.
/// @throws base::InputError that names each row whose range is not understood.
std::vector<ReferenceSection> referenceSections(const std::string& page_text);

/// File of the page "scenario" or "machine": as it was installed, or built, with the program.
/// @throws base::InputError for any other page, and where there is no such file.
std::filesystem::path referencePage(const std::string& page, const std::filesystem::path& bin_dir);

/// GET /api/reference: `page` is "scenario" or "machine". Gives {"sections": [{"title", "help_html",
/// "prefixes", "keys": [{"key", "path", "range", "kind", "count", "least", "most", "choices", "or_file",
/// "or_list", "or_section", "default", "required", "unit", "help_html"}]}]}: path is the key behind the first
/// prefix; help_html has text, <code>, <em>, <strong>, <p>, <ul>, <li> and <pre>, and no attributes.
/// @throws base::InputError as referencePage() and referenceSections().
std::string referenceJson(const std::string& page, const std::filesystem::path& bin_dir);

}  // namespace kerfbench::desk
