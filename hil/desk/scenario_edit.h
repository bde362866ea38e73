// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace kerfbench::desk {

/// A change of one key.
struct KeyEdit {
  /// Names of keys from the file down, not empty; the elements of a list have the names "0", "1" …, and the
  /// one behind the last may be set.
  std::vector<std::string> path;
  /// Number, text, true, false, list or mapping; null removes the key, so that what the file extends, or the
  /// default, holds again.
  nlohmann::ordered_json value;
};

/// Names of a path in words: "print.marks[0].x_mm". @throws base::InputError for words that are no path.
std::vector<std::string> keyPathFrom(std::string_view words);

/// Sets and removes keys of a YAML text, one after the other. Comments, order, blank lines, quotes, line ends
/// and the spelling of everything else stay byte for byte. A key that is not there goes behind the last of
/// its section, a section that is not there to the end of the one around it; with the last key of a section
/// the section goes, since an empty one would take away what the file extends. Comments at the end of a
/// removed line go, those above it stay. A key that is not there is removed without a change.
///
/// The text is read again after each edit, and is then the tree before with exactly that change.
/// @throws base::InputError for an edit that cannot be made so: a text that is no YAML mapping, a path
/// through a value that is none, a key given twice, aliases.
std::string edited(const std::string& text, const std::vector<KeyEdit>& edits);

/// Value of a key of a YAML text; null where it is not there. @throws base::InputError as edited().
nlohmann::ordered_json valueIn(const std::string& text, std::string_view path);

/// POST /api/edit: {"text", "set": [{"path": "belt.speed_mm_s", "value": 60}]} gives {"text"}. A path may
/// also be a list of names, for those that hold points: ["layers", "a.b"].
/// @throws base::InputError as edited(), and for a body that is not this.
std::string editJson(const std::string& body);

}  // namespace kerfbench::desk
