// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/key_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "hil/base/yaml_reader.h"

namespace kerfbench::campaign {
namespace {

/// A mapping of YAML: sections and values by name.
struct Section {
  std::map<std::string, Section> sections;
  std::map<std::string, std::string> values;
};

void appendTo(std::string& text, const Section& section, std::size_t depth) {
  const std::string indent(2 * depth, ' ');
  for (const auto& [name, value] : section.values) text += fmt::format("{}{}: {}\n", indent, name, value);
  for (const auto& [name, below] : section.sections) {
    text += fmt::format("{}{}:\n", indent, name);
    appendTo(text, below, depth + 1);
  }
}

/// The section of a key, and the key's own name.
std::pair<base::YamlReader, std::string> ownerOf(const std::filesystem::path& file, std::string_view key) {
  base::YamlReader section = base::YamlReader::openFile(file);
  for (auto dot = key.find('.'); dot != std::string_view::npos; dot = key.find('.')) {
    section = section.section(key.substr(0, dot));
    key.remove_prefix(dot + 1);
  }
  return {std::move(section), std::string(key)};
}

}  // namespace

bool isKeyPath(const std::string& text) {
  bool name_begun = false;
  for (const char c : text) {
    if (c == '.') {
      if (!name_begun) return false;
      name_begun = false;
    } else if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-') {
      name_begun = true;
    } else {
      return false;
    }
  }
  return name_begun;
}

std::string yamlOf(const std::vector<KeyValue>& keys) {
  Section root;
  for (const auto& [key, value] : keys) {
    Section* at = &root;
    std::string_view rest = key;
    for (auto dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
      at = &at->sections[std::string(rest.substr(0, dot))];
      rest.remove_prefix(dot + 1);
    }
    at->values[std::string(rest)] = value;
  }
  std::string text;
  appendTo(text, root, 0);
  return text;
}

std::optional<std::string> textAt(const std::filesystem::path& file, const std::string& key) {
  auto [section, name] = ownerOf(file, key);
  if (!section.has(name) || section.isList(name) || section.isMapping(name)) return std::nullopt;
  return section.text(name);
}

std::optional<std::filesystem::path> fileAt(const std::filesystem::path& file, const std::string& key) {
  auto [section, name] = ownerOf(file, key);
  if (!section.has(name) || section.isList(name) || section.isMapping(name)) return std::nullopt;
  return (section.folderOf(name) / section.text(name)).lexically_normal();
}

}  // namespace kerfbench::campaign
