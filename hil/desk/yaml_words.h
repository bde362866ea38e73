// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

// Private to hil/desk.
namespace kerfbench::desk {

/// A text as a scalar that reads as this very text and is no number, true, false or null: plain where it may
/// be, else in double quotes; in single ones where `quote` is one and the text allows it.
std::string yamlScalar(std::string_view text, char quote = '\0');

/// A value on one line: scalars, [lists], {mappings}.
std::string yamlInline(const nlohmann::ordered_json& value, char quote = '\0');

/// True where the value is better read in lines of its own: a mapping, or a list with mappings in it.
bool needsLines(const nlohmann::ordered_json& value);

/// Lines of a value that needsLines(), each indented by `indent` and ended by `line_end`.
std::string yamlLines(const nlohmann::ordered_json& value, int indent, std::string_view line_end);

}  // namespace kerfbench::desk
