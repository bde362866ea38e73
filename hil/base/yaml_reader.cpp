// SPDX-License-Identifier: Apache-2.0
#include "hil/base/yaml_reader.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hil/base/config_text.h"
#include "hil/base/input_file.h"
#include "hil/base/near_word.h"
#include "hil/base/text.h"
#include "hil/base/utf8.h"

namespace kerfbench::base {

namespace {

constexpr const char* kHasControl = "has a control character";
constexpr std::size_t kMostKeyBytes = 120;
constexpr std::size_t kMostTold = 50;

// Line and column, from 1.
struct KeyPlace {
  int line{1};
  int column{1};
};

KeyPlace placeAt(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

// The keys of one mapping and which of them the program asked for. Outlives the reader of its section, so
// that finish() sees every section that was ever opened.
struct KeyBook {
  std::filesystem::path path;
  std::string prefix;
  KeyPlace place;
  std::set<std::string, std::less<>> asked;
  std::vector<std::pair<std::string, KeyPlace>> keys;

  [[nodiscard]] bool has(std::string_view key) const {
    return std::ranges::find(keys, key, &std::pair<std::string, KeyPlace>::first) != keys.end();
  }
  // Whether this is the top of a file that has nothing of what is looked for, not even mistyped: it may be
  // anybody's, and is not quoted.
  [[nodiscard]] bool isForeign() const {
    const std::vector<std::string> known(asked.begin(), asked.end());
    return prefix.empty() && !keys.empty() && std::ranges::none_of(keys, [&](const auto& key) {
             return asked.contains(key.first) || !didYouMean(key.first, known).empty();
           });
  }
  [[nodiscard]] KeyPlace placeOf(std::string_view key) const {
    const auto found = std::ranges::find(keys, key, &std::pair<std::string, KeyPlace>::first);
    return found == keys.end() ? place : found->second;
  }
};

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

// Whether a text has no control characters but line ends and tabs, which blocks of lines have.
bool isPlain(std::string_view text) { return markupText(text) == text; }

bool given(const YAML::Node& node) { return node.IsDefined() && !node.IsNull(); }

}  // namespace

struct YamlReader::File {
  std::filesystem::path
      path;  // Path of the file that was opened; a file that it extends has its own in its books.
  std::vector<Fault> faults;
  std::vector<std::shared_ptr<KeyBook>> books;
  std::map<std::string, Asked> asked;
  std::vector<std::filesystem::path> inputs;

  void depend(const std::filesystem::path& on) {
    const std::filesystem::path whole = std::filesystem::absolute(on).lexically_normal();
    if (std::ranges::find(inputs, whole) == inputs.end()) inputs.push_back(whole);
  }
};

// One mapping, and below it the mapping that it extends, if any.
struct YamlReader::Node {
  Node(std::shared_ptr<File> the_file, const YAML::Node& the_yaml, KeyBook the_book,
       std::shared_ptr<Node> the_base)
      : file(std::move(the_file)),
        yaml(the_yaml),
        book(std::make_shared<KeyBook>(std::move(the_book))),
        base(std::move(the_base)) {
    if (yaml.IsMap()) {
      for (const auto& entry : yaml)
        book->keys.emplace_back(entry.first.Scalar(), placeAt(entry.first.Mark()));
    }
    file->books.push_back(book);
  }

  std::shared_ptr<File> file;
  YAML::Node yaml;  // Null for a section that is missing.
  std::shared_ptr<KeyBook> book;
  std::shared_ptr<Node> base;

  // Whose the key is: the first of the chain that gives it, else this.
  [[nodiscard]] const Node& ownerOf(std::string_view key) const {
    for (const Node* node = this; node != nullptr; node = node->base.get()) {
      if (node->book->has(key)) return *node;
    }
    return *this;
  }
  void fault(std::string_view key, std::string_view message) const {
    const KeyBook& owner = *ownerOf(key).book;
    const KeyPlace place = owner.placeOf(key);
    file->faults.push_back({owner.path, place.line, place.column,
                            printable(owner.prefix + std::string(key), kMostKeyBytes), std::string(message)});
  }
  [[nodiscard]] bool isText(std::string_view key) const {
    const YAML::Node constant = ownerOf(key).yaml;
    if (!constant.IsMap()) return false;
    const YAML::Node value = constant[std::string(key)];
    return given(value) && value.IsScalar();
  }
  // The value at `key`, or an undefined node; notes that the key is known.
  YAML::Node take(std::string_view key, const std::optional<Range>& range = std::nullopt) {
    for (Node* node = this; node != nullptr; node = node->base.get()) node->book->asked.emplace(key);
    const YAML::Node constant = ownerOf(key).yaml;
    const YAML::Node value =
        constant.IsMap() ? constant[std::string(key)] : YAML::Node(YAML::NodeType::Undefined);
    Asked& asked = file->asked[withoutIndices(book->prefix) + std::string(key)];
    if (!asked.range) asked.range = range;
    asked.given = asked.given || given(value);
    return value;
  }
};

namespace {

[[noreturn]] void refuseConfig(const std::filesystem::path& path, const std::string& refusal) {
  throw ConfigError(fmt::format("{}: {}", path.string(), refusal));
}

// The mapping in the text of a file.
YAML::Node mappingIn(const std::string& text, const std::filesystem::path& path) {
  if (text.size() > kLargestConfig_bytes)
    refuseConfig(path,
                 fmt::format("has {} bytes, and at most {} are read", text.size(), kLargestConfig_bytes));
  YAML::Node yaml;
  try {
    std::vector<YAML::Node> documents = YAML::LoadAll(text);
    std::erase_if(documents, [](const YAML::Node& document) { return !given(document); });
    if (documents.size() > 1)
      refuseConfig(path, fmt::format("holds {} documents of YAML (behind ---), and one is expected",
                                     documents.size()));
    if (!documents.empty()) yaml = documents.front();
  } catch (const YAML::Exception& e) {
    throw ConfigError(fmt::format("{}:{}: {}", path.string(), e.mark.line + 1, e.msg));
  }
  if (!yaml.IsMap()) throw ConfigError(fmt::format("{}:1: expected 'key: value' lines", path.string()));
  return yaml;
}

// Whatever a scenario extends, somebody else may own and keep from others: its name must be that of settings.
bool isConfigName(const std::filesystem::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

}  // namespace

std::string configText(const std::filesystem::path& path) {
  InputContent content = readInput(path, kLargestConfig_bytes);
  if (!content.bytes) refuseConfig(path, content.refusal);
  return *std::move(content.bytes);
}

YamlReader::YamlReader(std::shared_ptr<Node> node) : node_(std::move(node)) {}

YamlReader YamlReader::openFile(const std::filesystem::path& path) { return openChain(path, nullptr); }

YamlReader YamlReader::openText(const std::filesystem::path& path, const std::string& text) {
  return openChain(path, &text);
}

YamlReader YamlReader::openChain(const std::filesystem::path& path, const std::string* text) {
  constexpr int kDeepest = 8;
  auto file = std::make_shared<File>();
  file->path = path;
  // From the file asked for down to the one that extends nothing.
  std::vector<std::pair<std::filesystem::path, YAML::Node>> chain;
  for (std::filesystem::path next = path; !next.empty();) {
    if (chain.size() == kDeepest) {
      throw ConfigError(fmt::format("{}: extends more than {} files deep", path.string(), kDeepest));
    }
    const bool is_given = chain.empty() && text != nullptr;
    chain.emplace_back(next, mappingIn(is_given ? *text : configText(next), next));
    file->depend(next);
    const YAML::Node constant = chain.back().second;
    const YAML::Node extends = constant["extends"];
    if (!given(extends) || !extends.IsScalar()) break;
    next = next.parent_path() / extends.Scalar();
    if (!isConfigName(next))
      refuseConfig(chain.back().first,
                   fmt::format("extends: '{}' is no .yaml file, and no other is read", extends.Scalar()));
  }
  std::shared_ptr<Node> node;
  for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
    node = std::make_shared<Node>(file, it->second, KeyBook{it->first, "", {}, {"extends"}, {}},
                                  std::move(node));
  }
  return YamlReader(std::move(node));
}

bool isYamlValue(const std::string& text) {
  if (text.empty() || text.find_first_of("\n\r") != std::string::npos) return false;
  try {
    const YAML::Node node = YAML::Load(fmt::format("key: {}\n", text));
    return node.IsMap() && node.size() == 1 && node["key"].IsDefined();
  } catch (const YAML::Exception&) {
    return false;
  }
}

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
  const YAML::Node constant = node_->yaml;
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

std::vector<YamlReader::Asked> YamlReader::asked() const {
  std::vector<Asked> result;
  for (const auto& [key, asked] : node_->file->asked) result.push_back({key, asked.range, asked.given});
  return result;
}

std::string YamlReader::placeOf(std::string_view whole_key) const {
  const std::string key(whole_key);
  const auto dot = key.rfind('.');
  const std::string prefix = dot == std::string::npos ? "" : key.substr(0, dot + 1);
  const std::string last = dot == std::string::npos ? key : key.substr(dot + 1);
  // What extends a file has its books after those of that file.
  for (auto book = node_->file->books.rbegin(); book != node_->file->books.rend(); ++book) {
    if ((*book)->prefix == prefix && (*book)->has(last))
      return fmt::format("{}:{}", (*book)->path.string(), (*book)->placeOf(last).line);
  }
  if (dot != std::string::npos) return placeOf(key.substr(0, dot));
  return fmt::format("{}:1", path().string());
}

void YamlReader::fault(std::string_view key, std::string_view message) { node_->fault(key, message); }

const std::filesystem::path& YamlReader::path() const { return node_->file->path; }

void YamlReader::names(const std::filesystem::path& path) { node_->file->depend(path); }

std::vector<std::filesystem::path> YamlReader::inputs() const { return node_->file->inputs; }

std::filesystem::path YamlReader::folderOf(std::string_view key) const {
  return std::filesystem::absolute(node_->ownerOf(key).book->path).parent_path();
}

std::vector<YamlReader::Fault> YamlReader::faults() const {
  std::vector<Fault> faults = node_->file->faults;
  for (const auto& book : node_->file->books) {
    if (book->isForeign()) {
      faults.push_back(
          {book->path, 1, 1, "",
           fmt::format("none of its keys is known (known here: {})", fmt::join(book->asked, ", "))});
      continue;
    }
    std::set<std::string, std::less<>> seen;
    for (const auto& [key, place] : book->keys) {
      const auto add = [&, &key = key, &place = place](std::string message) {
        faults.push_back({book->path, place.line, place.column, printable(book->prefix + key, kMostKeyBytes),
                          std::move(message)});
      };
      if (!book->asked.contains(key)) {
        const std::vector<std::string> known(book->asked.begin(), book->asked.end());
        const std::string near = didYouMean(key, known);
        add(fmt::format("unknown key{}{} (known here: {})", near.empty() ? "" : ".", near,
                        fmt::join(known, ", ")));
      } else if (!seen.insert(key).second) {
        add("given twice");
      }
    }
  }
  std::ranges::stable_sort(faults, [](const Fault& a, const Fault& b) {
    return a.path != b.path ? a.path < b.path : a.line < b.line;
  });
  return faults;
}

void YamlReader::finish() {
  std::string message;
  const std::vector<Fault> all = faults();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Fault& fault = all[i];
    if (i == kMostTold) {
      message += fmt::format("\n{}: {} faults more", fault.path.string(), all.size() - kMostTold);
      break;
    }
    message += fmt::format("{}{}:{}: {}{}{}", message.empty() ? "" : "\n", fault.path.string(), fault.line,
                           fault.key, fault.key.empty() ? "" : ": ", fault.message);
  }
  if (!message.empty()) throw ConfigError(message);
}

}  // namespace kerfbench::base
