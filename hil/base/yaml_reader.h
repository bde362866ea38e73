// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerfbench::base {

/// A configuration file that cannot be used; what() has one line per fault: "file:line: key: what is wrong".
class ConfigError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Whether a text stands for one value of YAML on one line, as it may stand behind "key: ": "200", "fast",
/// "[1, 2]", "{a: 1}", "~".
bool isYamlValue(const std::string& text);

/// Reads a YAML mapping strictly: every key must be asked for, every value checked, and all faults are
/// collected so that the user sees them at once. Typical use:
///
///     auto file = YamlReader::openFile("machine.yaml");
///     auto optics = file.section("optics");
///     double throw_mm = optics.number("throw_mm", {.min = 1, .max = 5000});
///     file.finish();  // throws ConfigError if anything was wrong or left over
///
/// A file may begin with `extends: other.yaml`: what it does not say itself is taken from there, section by
/// section, key by key (lists are taken whole). File names inside an extended file keep their meaning from
/// its own folder: see folderOf().
class YamlReader {
 public:
  /// @throws ConfigError if the file is missing or no YAML mapping.
  static YamlReader openFile(const std::filesystem::path& path);
  /// Reads a text as if it were the file `path`, which need not be there; what it extends is read from files.
  /// @throws ConfigError as openFile().
  static YamlReader openText(const std::filesystem::path& path, const std::string& text);

  struct Range {
    double min{-1e300};
    double max{1e300};
    std::optional<double> fallback{};  ///< Absent: the key is required.
  };
  double number(std::string_view key, const Range& range);
  std::int64_t integer(std::string_view key, const Range& range);
  bool boolean(std::string_view key, std::optional<bool> fallback = std::nullopt);
  std::string text(std::string_view key, std::optional<std::string> fallback = std::nullopt);
  /// One of `allowed`.
  std::string choice(std::string_view key, const std::vector<std::string>& allowed,
                     std::optional<std::string> fallback = std::nullopt);
  std::vector<double> numbers(std::string_view key, std::size_t count,
                              std::optional<std::vector<double>> fallback = std::nullopt);
  /// A list of `count` numbers, each within the range; the fallback, if any, is that of each.
  std::vector<double> numbers(std::string_view key, std::size_t count, const Range& each);
  /// A nested mapping; a missing one reads as empty (its required keys then complain).
  YamlReader section(std::string_view key);
  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] bool isList(std::string_view key) const;
  /// Each element of a list of mappings.
  std::vector<YamlReader> list(std::string_view key);
  /// Each element of a list of texts; empty where the key is missing.
  std::vector<std::string> texts(std::string_view key);
  /// All keys and texts of a nested mapping of free keys (layer names, say).
  std::vector<std::pair<std::string, std::string>> pairs(std::string_view key);

  [[nodiscard]] bool isMapping(std::string_view key) const;
  /// All texts under a nested mapping of free keys, however deep, each with the keys that lead to it.
  std::vector<std::pair<std::vector<std::string>, std::string>> leaves(std::string_view key);

  /// A key that was asked for, in this file or one that it extends; elements of lists have no number:
  /// "a[].b".
  struct Asked {
    std::string key;
    std::optional<Range> range;  ///< Range of a number; nullopt for anything else.
    bool given{};                ///< Somewhere in the file.
  };
  /// Every key asked for so far, sorted, each once (with the range of the first time).
  [[nodiscard]] std::vector<Asked> asked() const;
  /// "file:line" of a key, with its sections ("belt.encoder.count_mm"); where it is not given, of the section
  /// that would hold it, else of the file's first line.
  [[nodiscard]] std::string placeOf(std::string_view whole_key) const;

  /// Adds a fault of the caller's own at a key.
  void fault(std::string_view key, std::string_view message);
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Notes that this file names another, on which its meaning depends.
  void names(const std::filesystem::path& path);
  /// All on which the meaning of this file depends: itself, what it extends, what it names; absolute, each
  /// once.
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const;
  /// The folder of the file that gives `key`, for file names relative to it.
  [[nodiscard]] std::filesystem::path folderOf(std::string_view key) const;
  /// A fault at its place in a file.
  struct Fault {
    std::filesystem::path path;
    int line{};  ///< Line and column of the key, from 1.
    int column{};
    std::string key;  ///< With its sections: "belt.speed_mm_s".
    std::string message;
  };
  /// All faults so far, by file and line, unknown keys in every section opened among them.
  [[nodiscard]] std::vector<Fault> faults() const;
  /// @throws ConfigError listing all faults(), if there is one.
  void finish();

 private:
  struct Node;
  struct File;
  static YamlReader openChain(const std::filesystem::path& path, const std::string* text);
  explicit YamlReader(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

}  // namespace kerfbench::base
