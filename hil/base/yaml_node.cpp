// SPDX-License-Identifier: Apache-2.0
#include "hil/base/yaml_node.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "hil/base/near_word.h"
#include "hil/base/text.h"

namespace kerfbench::base {
namespace {

std::string withoutIndices(const std::string& prefix) {
  std::string result;
  bool inside = false;
  for (const char c : prefix) {
    if (c == ']') inside = false;
    if (!inside) result += c;
    if (c == '[') inside = true;
  }
  return result;
}

}  // namespace

KeyPlace placeAt(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

bool given(const YAML::Node& node) { return node.IsDefined() && !node.IsNull(); }

bool KeyBook::has(std::string_view key) const {
  return std::ranges::find(keys, key, &std::pair<std::string, KeyPlace>::first) != keys.end();
}

bool KeyBook::isForeign() const {
  const std::vector<std::string> known(asked.begin(), asked.end());
  return prefix.empty() && !keys.empty() && std::ranges::none_of(keys, [&](const auto& key) {
           return asked.contains(key.first) || !didYouMean(key.first, known).empty();
         });
}

KeyPlace KeyBook::placeOf(std::string_view key) const {
  const auto found = std::ranges::find(keys, key, &std::pair<std::string, KeyPlace>::first);
  return found == keys.end() ? place : found->second;
}

void YamlReader::File::depend(const std::filesystem::path& on) {
  const std::filesystem::path whole = std::filesystem::absolute(on).lexically_normal();
  if (std::ranges::find(inputs, whole) == inputs.end()) inputs.push_back(whole);
}

YamlReader::Node::Node(std::shared_ptr<File> the_file, const YAML::Node& the_yaml, KeyBook the_book,
                       std::shared_ptr<Node> the_base)
    : file(std::move(the_file)),
      yaml(std::make_shared<const YAML::Node>(the_yaml)),
      book(std::make_shared<KeyBook>(std::move(the_book))),
      base(std::move(the_base)) {
  if (yaml->IsMap()) {
    for (const auto& entry : *yaml)
      book->keys.emplace_back(entry.first.Scalar(), placeAt(entry.first.Mark()));
  }
  file->books.push_back(book);
}

const YamlReader::Node& YamlReader::Node::ownerOf(std::string_view key) const {
  for (const Node* node = this; node != nullptr; node = node->base.get()) {
    if (node->book->has(key)) return *node;
  }
  return *this;
}

void YamlReader::Node::fault(std::string_view key, std::string_view message) const {
  const KeyBook& owner = *ownerOf(key).book;
  const KeyPlace place = owner.placeOf(key);
  file->faults.push_back({owner.path, place.line, place.column,
                          printable(owner.prefix + std::string(key), kMostKeyBytes), std::string(message)});
}

bool YamlReader::Node::isText(std::string_view key) const {
  const YAML::Node& constant = *ownerOf(key).yaml;
  if (!constant.IsMap()) return false;
  const YAML::Node value = constant[std::string(key)];
  return given(value) && value.IsScalar();
}

YAML::Node YamlReader::Node::take(std::string_view key, const std::optional<Range>& range) {
  for (Node* node = this; node != nullptr; node = node->base.get()) node->book->asked.emplace(key);
  const YAML::Node& constant = *ownerOf(key).yaml;
  const YAML::Node value =
      constant.IsMap() ? constant[std::string(key)] : YAML::Node(YAML::NodeType::Undefined);
  Asked& asked = file->asked[withoutIndices(book->prefix) + std::string(key)];
  if (!asked.range) asked.range = range;
  asked.given = asked.given || given(value);
  return value;
}

}  // namespace kerfbench::base
