// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace kerfbench::desk {

/// A change of one key. `value`: number, text, true, false, list or mapping; null removes the key, so that
/// what the file extends, or the default, holds again.
struct KeyEdit {
  std::vector<std::string> path;  ///< Names of keys from the file down; not empty.
  nlohmann::json value;
};

/// Sets and removes keys of a YAML text. Comments, order, blank lines, quotes and the spelling of everything
/// else stay byte for byte; a key that is not there goes to the end of its section, a section that is not
/// there to the end of the text. A section that becomes empty is removed. Block and flow style are kept.
/// @throws base::InputError with every edit that cannot be made: the text is no YAML mapping, a path leads
/// through a value that is none, an alias or an anchor would change another place.
std::string edited(const std::string& text, const std::vector<KeyEdit>& edits);

/// POST /api/edit: {"text", "set": [{"path": "belt.speed_mm_s", "value": 60}]} gives {"text"}. A path is
/// names of keys with points between, or, for names that hold points, a list: ["layers", "a.b"].
/// @throws base::InputError as edited(), and for a body that is not this.
std::string editJson(const std::string& body);

}  // namespace kerfbench::desk
