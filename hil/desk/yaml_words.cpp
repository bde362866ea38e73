// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/yaml_words.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "hil/desk/json_text.h"
#include "hil/desk/yaml_layout.h"

namespace kerfbench::desk {
namespace {

using nlohmann::ordered_json;

/// Letters that mean nothing to YAML anywhere in a plain scalar, in braces neither.
bool isHarmless(char c) {
  const auto u = static_cast<unsigned char>(c);
  return std::isalnum(u) != 0 || u >= 0x80U || std::string_view("_./+-()").find(c) != std::string_view::npos;
}

bool readsAsText(const std::string& text) {
  return plainValue(text).is_string() && text != "null" && text != "Null" && text != "NULL";
}

bool mayBePlain(std::string_view text) {
  if (text.empty() || text.front() == ' ' || text.back() == ' ') return false;
  // Where '-', '.' and '+' begin a text it may be an element, a number or the end of a document.
  const auto first = static_cast<unsigned char>(text.front());
  if (std::isalpha(first) == 0 && std::string_view("_/").find(text.front()) == std::string_view::npos &&
      !text.starts_with("../") && std::isdigit(first) == 0)
    return false;
  if (!std::ranges::all_of(text, [](char c) { return isHarmless(c) || c == ' '; })) return false;
  // What is not UTF-8 would not come back.
  if (std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) >= 0x80U; })) return false;
  return readsAsText(std::string(text));
}

std::string numberWords(const ordered_json& value) {
  if (value.is_number_integer() || value.is_number_unsigned()) return value.dump();
  return fmt::format("{}", value.get<double>());
}

}  // namespace

std::string yamlScalar(std::string_view text, char quote) {
  const bool has_controls =
      std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7f; });
  if (quote == '\'' && !has_controls) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
    return quoted + "'";
  }
  if (quote == '\0' && mayBePlain(text)) return std::string(text);
  // JSON's text is one of YAML in double quotes.
  return jsonText(std::string(text));
}

std::string yamlInline(const ordered_json& value, char quote) {
  if (value.is_null()) return "~";
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number()) return numberWords(value);
  if (value.is_string()) return yamlScalar(value.get<std::string>(), quote);
  std::string text;
  for (const auto& [key, element] : value.items()) {
    text += text.empty() ? "" : ", ";
    text += (value.is_object() ? yamlScalar(key) + ": " : "") + yamlInline(element);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

bool needsLines(const ordered_json& value) {
  if (value.is_object()) return !value.empty();
  return value.is_array() &&
         std::ranges::any_of(value, [](const ordered_json& element) { return element.is_structured(); });
}

std::string yamlLines(const ordered_json& value, int indent, std::string_view line_end) {
  std::string text;
  const std::string before(static_cast<std::size_t>(indent), ' ');
  for (const auto& [key, element] : value.items()) {
    if (value.is_array()) {
      text += fmt::format("{}- {}{}", before, yamlInline(element), line_end);
    } else if (needsLines(element)) {
      text += fmt::format("{}{}:{}{}", before, yamlScalar(key), line_end,
                          yamlLines(element, indent + 2, line_end));
    } else {
      text += fmt::format("{}{}: {}{}", before, yamlScalar(key), yamlInline(element), line_end);
    }
  }
  return text;
}

}  // namespace kerfbench::desk
