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

/// A key as docs/reference describes it.
struct ReferenceKey {
  std::string path;   ///< With its sections: "belt.speed_mm_s"; elements of lists as "print.marks[].x_mm".
  KeyKind kind{};     ///< kChoice also where one of the choices is to be replaced by a list or a file.
  std::string range;  ///< As the page has it.
  std::optional<double> least, most;        ///< Of a number, or of each of several.
  std::size_t count{1};                     ///< How many numbers; 1 for all other kinds.
  std::vector<std::string> choices;         ///< Words that may stand there.
  bool or_file{}, or_list{}, or_section{};  ///< What else may stand there instead of one of the choices.
  std::string fallback;                     ///< Default as the page has it, without "required"; empty: none.
  bool required{};
  std::string unit;  ///< From the key's ending: "mm/s"; empty: none.
  std::string help;  ///< Meaning, in the page's Markdown.
};

struct ReferenceSection {
  std::string title;                  ///< Heading of the page.
  std::string text;                   ///< Markdown between the heading and the table.
  std::vector<std::string> prefixes;  ///< Sections to which the keys belong; one empty text for none.
  std::vector<ReferenceKey> keys;     ///< Under the first prefix; those of the others differ by it alone.
};

/// Reads the tables `key | range | default | meaning` of a page. @throws base::InputError where it cannot be
/// read.
std::vector<ReferenceSection> referenceSections(const std::filesystem::path& page);

/// Folder of the reference pages: beside the programs as installed, or that of the repository.
/// @throws base::InputError where there is none.
std::filesystem::path referenceFolder(const std::filesystem::path& bin_dir);

/// GET /api/reference: `page` is "scenario" or "machine". Gives {"sections": [{"title", "help_html",
/// "prefixes", "keys": [{"key", "path", "range", "kind", "count", "least", "most", "choices", "or_file",
/// "or_list", "or_section", "default", "required", "unit", "help_html"}]}]}; help_html has text, <code>,
/// <em>, <strong>, <p>, <ul>, <li>, <pre> and links within the reference alone.
/// @throws base::InputError for any other page.
std::string referenceJson(const std::string& page, const std::filesystem::path& bin_dir);

}  // namespace kerfbench::desk
