// SPDX-License-Identifier: Apache-2.0
// The values of a file's keys.
#include "hil/base/yaml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "hil/base/text.h"
#include "hil/base/utf8.h"
#include "hil/base/yaml_node.h"

namespace kerfbench::base {
namespace {

constexpr const char* kHasControl = "has a control character";

// Whether a text has no control characters but line ends and tabs, which blocks of lines have.
bool isPlain(std::string_view text) { return markupText(text) == text; }

}  // namespace

YamlReader::YamlReader(std::shared_ptr<Node> node) : node_(std::move(node)) {}

double YamlReader::number(std::string_view key, const Range& range) {
  const YAML::Node value = node_->take(key, range);
  if (!given(value)) {
    if (range.fallback) return *range.fallback;
    node_->fault(key, "missing");
    return range.min > -1e299 ? range.min : 0.0;
  }
  double number = 0.0;
  if (!value.IsScalar() || !YAML::convert<double>::decode(value, number) || !std::isfinite(number)) {
    node_->fault(key, fmt::format("{} is not a number", value.IsScalar() ? inQuotes(value.Scalar()) : "'…'"));
    return 0.0;
  }
  if (number < range.min || number > range.max) {
    node_->fault(key, fmt::format("{} is outside {} … {}", number, range.min, range.max));
  }
  return number;
}

std::int64_t YamlReader::integer(std::string_view key, const Range& range) {
  const double value = number(key, range);
  if (value != std::floor(value)) node_->fault(key, fmt::format("{} is not a whole number", value));
  return static_cast<std::int64_t>(std::clamp(value, -9e15, 9e15));
}

bool YamlReader::boolean(std::string_view key, std::optional<bool> fallback) {
  const YAML::Node value = node_->take(key);
  bool result = false;
  if (!given(value)) {
    if (fallback) return *fallback;
    node_->fault(key, "missing");
  } else if (!value.IsScalar() || !YAML::convert<bool>::decode(value, result)) {
    node_->fault(key, "is neither true nor false");
  }
  return result;
}

std::string YamlReader::text(std::string_view key, std::optional<std::string> fallback) {
  const YAML::Node value = node_->take(key);
  if (!given(value)) {
    if (fallback) return *fallback;
    node_->fault(key, "missing");
    return {};
  }
  if (!value.IsScalar()) {
    node_->fault(key, "is not a text");
    return {};
  }
  if (!isPlain(value.Scalar())) node_->fault(key, kHasControl);
  return value.Scalar();
}

std::string YamlReader::choice(std::string_view key, const std::vector<std::string>& allowed,
                               std::optional<std::string> fallback) {
  const bool was_given = given(node_->take(key));
  std::string value = text(key, std::move(fallback));
  if (was_given && std::ranges::find(allowed, value) == allowed.end()) {
    node_->fault(key, fmt::format("{} is none of: {}", inQuotes(value), fmt::join(allowed, ", ")));
  }
  return value;
}

std::vector<double> YamlReader::numbers(std::string_view key, std::size_t count,
                                        std::optional<std::vector<double>> fallback) {
  const YAML::Node value = node_->take(key);
  std::vector<double> result;
  if (!given(value)) {
    if (fallback) return *fallback;
    node_->fault(key, "missing");
  } else {
    for (const YAML::Node& element : value) {
      double number = 0.0;
      if (element.IsScalar() && YAML::convert<double>::decode(element, number) && std::isfinite(number)) {
        result.push_back(number);
      }
    }
    if (!value.IsSequence() || value.size() != count || result.size() != count) {
      node_->fault(key, fmt::format("expected a list of {} numbers", count));
    }
  }
  result.resize(count, 0.0);
  return result;
}

std::vector<double> YamlReader::numbers(std::string_view key, std::size_t count, const Range& each) {
  (void)node_->take(key, each);
  std::optional<std::vector<double>> fallback;
  if (each.fallback) fallback = std::vector<double>(count, *each.fallback);
  std::vector<double> result = numbers(key, count, std::move(fallback));
  for (const double value : result) {
    if (!has(key) || (value >= each.min && value <= each.max)) continue;
    node_->fault(key, fmt::format("{} is outside {} … {}", value, each.min, each.max));
  }
  return result;
}

YamlReader YamlReader::section(std::string_view key) {
  // Sections of the files extended come below, key by key.
  // A mapping takes the place of a text in the file that is extended.
  const bool is_replaced = node_->base && node_->book->has(key) && node_->base->isText(key);
  std::shared_ptr<Node> below =
      node_->base && !is_replaced ? YamlReader(node_->base).section(key).node_ : nullptr;
  node_->book->asked.emplace(key);
  const YAML::Node& constant = *node_->yaml;
  const YAML::Node value =
      constant.IsMap() ? constant[std::string(key)] : YAML::Node(YAML::NodeType::Undefined);
  const bool is_given = given(value);
  if (is_given && !value.IsMap()) node_->fault(key, "expected 'key: value' lines under it");
  KeyBook book{
      node_->book->path, fmt::format("{}{}.", node_->book->prefix, key), node_->book->placeOf(key), {}, {}};
  return YamlReader(std::make_shared<Node>(node_->file, is_given && value.IsMap() ? value : YAML::Node(),
                                           std::move(book), std::move(below)));
}

bool YamlReader::has(std::string_view key) const { return given(node_->take(key)); }

bool YamlReader::isList(std::string_view key) const {
  const YAML::Node value = node_->take(key);
  return given(value) && value.IsSequence();
}

bool YamlReader::isMapping(std::string_view key) const {
  const YAML::Node value = node_->take(key);
  return given(value) && value.IsMap();
}

std::vector<YamlReader> YamlReader::list(std::string_view key) {
  const YAML::Node value = node_->take(key);
  std::vector<YamlReader> result;
  if (!given(value)) return result;
  if (!value.IsSequence()) {
    node_->fault(key, "expected a list ('- …' lines)");
    return result;
  }
  for (std::size_t i = 0; i < value.size(); ++i) {
    const YAML::Node element = value[i];
    if (!element.IsMap()) node_->fault(key, fmt::format("element {} is not 'key: value'", i));
    const KeyBook& owner = *node_->ownerOf(key).book;
    KeyBook book{owner.path, fmt::format("{}{}[{}].", owner.prefix, key, i), placeAt(element.Mark()), {}, {}};
    result.push_back(YamlReader(std::make_shared<Node>(node_->file, element.IsMap() ? element : YAML::Node(),
                                                       std::move(book), nullptr)));
  }
  return result;
}

std::vector<std::string> YamlReader::texts(std::string_view key) {
  const YAML::Node value = node_->take(key);
  std::vector<std::string> result;
  if (!given(value)) return result;
  if (!value.IsSequence()) {
    node_->fault(key, "expected a list of texts: [\"…\", \"…\"]");
    return result;
  }
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i].IsScalar()) {
      result.push_back(value[i].Scalar());
      if (!isPlain(result.back())) node_->fault(key, fmt::format("element {} {}", i, kHasControl));
    } else {
      node_->fault(key, fmt::format("element {} is not a text", i));
    }
  }
  return result;
}

std::vector<std::pair<std::string, std::string>> YamlReader::pairs(std::string_view key) {
  const YAML::Node value = node_->take(key);
  std::vector<std::pair<std::string, std::string>> result;
  if (!given(value)) return result;
  if (!value.IsMap()) {
    node_->fault(key, "expected 'key: value' lines under it");
    return result;
  }
  for (const auto& entry : value) {
    if (entry.first.IsScalar() && entry.second.IsScalar()) {
      result.emplace_back(entry.first.Scalar(), entry.second.Scalar());
      if (!isPlain(result.back().first) || !isPlain(result.back().second)) node_->fault(key, kHasControl);
    } else {
      node_->fault(key, "holds something that is not a text");
    }
  }
  return result;
}

std::vector<std::pair<std::vector<std::string>, std::string>> YamlReader::leaves(std::string_view key) {
  using Leaf = std::pair<std::vector<std::string>, std::string>;
  const YAML::Node value = node_->take(key);
  std::vector<Leaf> result;
  if (!given(value)) return result;
  constexpr std::size_t kDeepest = 8;
  const auto collect = [&](const auto& self, const YAML::Node& at, std::vector<std::string>& path) -> void {
    if (at.IsScalar() && !path.empty()) {
      result.emplace_back(path, at.Scalar());
      if (!isPlain(at.Scalar()) || !std::ranges::all_of(path, isPlain)) node_->fault(key, kHasControl);
      return;
    }
    if (!at.IsMap() || path.size() >= kDeepest) {
      node_->fault(key, "expected 'key: value' lines under it");
      return;
    }
    for (const auto& entry : at) {
      path.push_back(entry.first.IsScalar() ? entry.first.Scalar() : "?");
      self(self, entry.second, path);
      path.pop_back();
    }
  };
  std::vector<std::string> path;
  collect(collect, value, path);
  return result;
}

void YamlReader::fault(std::string_view key, std::string_view message) { node_->fault(key, message); }

const std::filesystem::path& YamlReader::path() const { return node_->file->path; }

void YamlReader::names(const std::filesystem::path& path) { node_->file->depend(path); }

std::vector<std::filesystem::path> YamlReader::inputs() const { return node_->file->inputs; }

std::filesystem::path YamlReader::folderOf(std::string_view key) const {
  return std::filesystem::absolute(node_->ownerOf(key).book->path).parent_path();
}

}  // namespace kerfbench::base
