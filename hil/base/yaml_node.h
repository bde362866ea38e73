// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the sources of YamlReader share; nobody else includes it.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/base/yaml_reader.h"

namespace YAML {
class Node;
struct Mark;
}  // namespace YAML

namespace kerfbench::base {

/// Most bytes of a key that are told.
inline constexpr std::size_t kMostKeyBytes = 120;

/// Line and column, from 1.
struct KeyPlace {
  int line{1};
  int column{1};
};

KeyPlace placeAt(const YAML::Mark& mark);

/// Whether a node stands there and is not empty ("~").
bool given(const YAML::Node& node);

/// The keys of one mapping and which of them the program asked for. Outlives the reader of its section, so
/// that finish() sees every section that was ever opened.
struct KeyBook {
  std::filesystem::path path;
  std::string prefix;
  KeyPlace place;
  std::set<std::string, std::less<>> asked;
  std::vector<std::pair<std::string, KeyPlace>> keys;

  [[nodiscard]] bool has(std::string_view key) const;
  /// Whether this is the top of a file that has nothing of what is looked for, not even mistyped: it may be
  /// anybody's, and is not quoted.
  [[nodiscard]] bool isForeign() const;
  [[nodiscard]] KeyPlace placeOf(std::string_view key) const;
};

/// Everything known about one file and those that it extends.
struct YamlReader::File {
  /// Path of the file that was opened; a file that it extends has its own in its books.
  std::filesystem::path path;
  std::vector<Fault> faults;
  std::vector<std::shared_ptr<KeyBook>> books;
  std::map<std::string, Asked> asked;
  std::vector<std::filesystem::path> inputs;

  void depend(const std::filesystem::path& on);
};

/// One mapping, and below it the mapping that it extends, if any.
struct YamlReader::Node {
  Node(std::shared_ptr<File> the_file, const YAML::Node& the_yaml, KeyBook the_book,
       std::shared_ptr<Node> the_base);

  std::shared_ptr<File> file;
  std::shared_ptr<const YAML::Node> yaml;  ///< Null for a section that is missing.
  std::shared_ptr<KeyBook> book;
  std::shared_ptr<Node> base;

  /// Whose the key is: the first of the chain that gives it, else this.
  [[nodiscard]] const Node& ownerOf(std::string_view key) const;
  void fault(std::string_view key, std::string_view message) const;
  [[nodiscard]] bool isText(std::string_view key) const;
  /// The value at `key`, or an undefined node; notes that the key is known.
  YAML::Node take(std::string_view key, const std::optional<Range>& range = std::nullopt);
};

}  // namespace kerfbench::base
