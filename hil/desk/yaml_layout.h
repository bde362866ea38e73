// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "hil/base/input_error.h"

// Private to hil/desk.
namespace kerfbench::desk {

/// A value of a YAML text with its place there, in bytes from the begin of the text.
struct YamlPart {
  enum class Kind { kScalar, kNull, kMap, kList };
  struct Entry;

  Kind kind{};
  bool is_flow{};         ///< Mapping or list: in braces or brackets.
  bool is_block_text{};   ///< Scalar: behind '|' or '>'.
  bool is_plain{};        ///< Scalar: without quotes, so that 60 is a number.
  bool has_properties{};  ///< True for a value with an anchor or a tag.
  std::string scalar;     ///< As it reads.
  std::size_t begin{};    ///< Place of the first byte; of an empty one, where it would begin.
  std::size_t end{};      ///< Behind its last byte, comments behind it left out.
  std::vector<Entry> entries;

  /// Entry of a mapping, or nothing. @throws base::InputError if the key is given twice.
  [[nodiscard]] const Entry* find(std::string_view key) const;
};

struct YamlPart::Entry {
  YamlPart key;         ///< Nothing for a list's element.
  std::size_t mark{};   ///< The ':' behind the key, or the '-' of an element.
  bool has_mark{true};  ///< False for a key in braces without ':', and an element in brackets.
  YamlPart value;
};

/// Largest text that is read.
inline constexpr std::size_t kMostYamlBytes = std::size_t{1} << 20U;

/// A text that is no YAML.
struct YamlFault : base::InputError {
  YamlFault(int at_line, int at_column, const std::string& what_is_wrong);
  int line{}, column{};  ///< From 1.
  std::string message;   ///< what() without the line.
};

/// Layout of a text of one document without byte-order mark; an empty text is an empty mapping.
/// @throws YamlFault where it is no YAML; base::InputError for what is not edited: aliases, keys that are no
/// text, several documents, too much text.
YamlPart layoutOf(const std::string& text);

/// A plain scalar as number, true or false where it reads so, else as text; "null" is a text here.
nlohmann::ordered_json plainValue(const std::string& text);

/// Value as JSON, keys in their order: plain scalars as numbers, true, false or null where they read so.
nlohmann::ordered_json valueOf(const YamlPart& part);

}  // namespace kerfbench::desk
