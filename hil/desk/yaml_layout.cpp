// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/yaml_layout.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "hil/base/input_error.h"

namespace kerfbench::desk {
namespace {

using Kind = YamlPart::Kind;

constexpr std::string_view kSpaces = " \t";
constexpr std::string_view kSpacesAndEnds = " \t\r\n";

[[noreturn]] void refuseAt(std::string_view text, std::size_t at, std::string_view what) {
  const auto line = 1 + std::ranges::count(text.substr(0, at), '\n');
  throw base::InputError(fmt::format("line {}: {}: edit this file as text", line, what));
}

/// Takes the parser's events and builds the parts, as yet with their begins alone.
class LayoutBuilder final : public YAML::EventHandler {
 public:
  explicit LayoutBuilder(std::string_view text) : text_(text) {}
  [[nodiscard]] YamlPart finished() && { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    YamlPart part{.kind = Kind::kNull, .is_plain = true, .begin = placeOf(mark)};
    part.has_properties = anchor != 0;
    put(std::move(part));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    refuseAt(text_, placeOf(mark), "an alias (*name)");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    YamlPart part{.kind = Kind::kScalar, .is_plain = tag == "?", .scalar = value, .begin = placeOf(mark)};
    // "?" and "!" are what the parser calls plain and quoted text without a tag.
    part.has_properties = anchor != 0 || (tag != "?" && tag != "!");
    put(std::move(part));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override {
    open(Kind::kList, mark, tag, anchor, style);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override {
    open(Kind::kMap, mark, tag, anchor, style);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlPart part;
    bool awaits_value{};  ///< Mapping: the last entry has a key alone.
  };

  static std::size_t placeOf(const YAML::Mark& mark) {
    return static_cast<std::size_t>(std::max(mark.pos, 0));
  }
  void open(Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            YAML::EmitterStyle::value style) {
    YamlPart part{.kind = kind, .is_flow = style == YAML::EmitterStyle::Flow, .begin = placeOf(mark)};
    part.has_properties = anchor != 0 || tag != "?";
    open_.push_back({std::move(part)});
  }
  void close() {
    YamlPart part = std::move(open_.back().part);
    open_.pop_back();
    put(std::move(part));
  }
  void put(YamlPart part) {
    if (open_.empty()) {
      root_ = std::move(part);
      return;
    }
    auto& [holder, awaits_value] = open_.back();
    if (holder.kind == Kind::kList) {
      holder.entries.push_back({.key = {}, .value = std::move(part)});
      return;
    }
    if (awaits_value) {
      holder.entries.back().value = std::move(part);
    } else if (part.kind == Kind::kScalar) {
      holder.entries.push_back({.key = std::move(part), .value = {}});
    } else {
      refuseAt(text_, part.begin, "a key that is no text");
    }
    awaits_value = !awaits_value;
  }

  std::string_view text_;
  YamlPart root_;
  std::vector<Open> open_;
};

/// Finds where parts end, which the parser does not tell.
class EndFinder {
 public:
  explicit EndFinder(std::string_view text) : text_(text) {}

  /// `indent`: of the block around the part, -1 for the whole text.
  void locate(YamlPart& part, int indent) const {
    if (part.has_properties) skipProperties(part);
    if (part.kind == Kind::kScalar) {
      part.end = scalarEnd(part, indent);
    } else if (part.kind == Kind::kMap) {
      locateMap(part);
    } else if (part.kind == Kind::kList) {
      locateList(part);
    }
  }

  /// Column of a place, from 0.
  [[nodiscard]] int columnOf(std::size_t at) const {
    const std::size_t end = at == 0 ? std::string_view::npos : text_.rfind('\n', at - 1);
    return static_cast<int>(end == std::string_view::npos ? at : at - end - 1);
  }

 private:
  void skipProperties(YamlPart& part) const {
    while (part.begin < text_.size() && (text_[part.begin] == '&' || text_[part.begin] == '!')) {
      part.begin = std::min(text_.find_first_of(kSpacesAndEnds, part.begin), text_.size());
      part.begin = skipBlank(part.begin);
    }
  }

  /// Next byte that is neither blank nor in a comment.
  [[nodiscard]] std::size_t skipBlank(std::size_t at) const {
    while (at < text_.size()) {
      at = std::min(text_.find_first_not_of(kSpacesAndEnds, at), text_.size());
      if (at == text_.size() || text_[at] != '#') return at;
      at = std::min(text_.find('\n', at), text_.size());
    }
    return at;
  }

  [[nodiscard]] std::size_t scalarEnd(YamlPart& part, int indent) const {
    const char first = part.begin < text_.size() ? text_[part.begin] : ' ';
    if (!part.is_plain && first == '"') return quotedEnd(part.begin, '"');
    if (!part.is_plain && first == '\'') return quotedEnd(part.begin, '\'');
    if (!part.is_plain && (first == '|' || first == '>')) {
      part.is_block_text = true;
      return blockTextEnd(part.begin, indent);
    }
    return plainEnd(part);
  }

  [[nodiscard]] std::size_t quotedEnd(std::size_t begin, char quote) const {
    for (std::size_t at = begin + 1; at < text_.size(); ++at) {
      if (quote == '"' && text_[at] == '\\') {
        ++at;
      } else if (text_[at] == quote) {
        if (quote == '"' || at + 1 == text_.size() || text_[at + 1] != quote) return at + 1;
        ++at;
      }
    }
    refuseAt(text_, begin, "a text whose end is not found");
  }

  /// Lines that are farther in than what is around them belong to it; blank ones at its end do not.
  [[nodiscard]] std::size_t blockTextEnd(std::size_t begin, int indent) const {
    std::size_t line = std::min(text_.find('\n', begin), text_.size());
    std::size_t end = line;
    while (line < text_.size()) {
      const std::size_t first = text_.find_first_not_of(" ", line + 1);
      const std::size_t stop = std::min(text_.find('\n', line + 1), text_.size());
      const bool is_blank = first == std::string_view::npos || first >= stop || text_[first] == '\r';
      if (!is_blank && static_cast<int>(first - line - 1) <= indent) break;
      if (!is_blank) end = stop;
      line = stop;
    }
    while (end > begin && text_[end - 1] == '\r') --end;
    return end;
  }

  /// Walks along the text and what it reads as: runs of blanks and line ends may have become a blank or line
  /// ends.
  [[nodiscard]] std::size_t plainEnd(const YamlPart& part) const {
    const std::string& value = part.scalar;
    std::size_t at = part.begin;
    for (std::size_t i = 0; i < value.size();) {
      const bool is_blank = kSpacesAndEnds.find(value[i]) != std::string_view::npos;
      if (is_blank) {
        i = std::min(value.find_first_not_of(kSpacesAndEnds, i), value.size());
        at = std::min(text_.find_first_not_of(kSpacesAndEnds, at), text_.size());
      } else if (at < text_.size() && text_[at] == value[i]) {
        ++at;
        ++i;
      } else {
        refuseAt(text_, part.begin, "a value whose end is not found");
      }
    }
    return at;
  }

  /// A value that is not there, or a word for that: behind `after`.
  void locateNull(YamlPart& part, std::size_t after) const {
    const std::size_t at = std::min(text_.find_first_not_of(kSpaces, after), text_.size());
    for (const std::string_view word : {"~", "null", "Null", "NULL"}) {
      if (!text_.substr(at).starts_with(word)) continue;
      const std::size_t end = at + word.size();
      const bool is_whole =
          end == text_.size() || std::string_view(" \t\r\n,]}").find(text_[end]) != std::string_view::npos;
      if (!is_whole) continue;
      part.begin = at;
      part.end = end;
      return;
    }
    part.begin = part.end = after;
  }

  void locateMap(YamlPart& map) const {
    const bool has_braces = map.is_flow && map.begin < text_.size() && text_[map.begin] == '{';
    const int indent = map.is_flow || map.entries.empty() ? -1 : columnOf(map.entries.front().key.begin);
    std::size_t end = has_braces ? map.begin + 1 : map.begin;
    for (YamlPart::Entry& entry : map.entries) {
      locate(entry.key, indent);
      const std::size_t colon = std::min(text_.find_first_not_of(kSpaces, entry.key.end), text_.size());
      entry.has_mark = colon < text_.size() && text_[colon] == ':';
      entry.mark = entry.has_mark ? colon : entry.key.end;
      if (!entry.has_mark && !map.is_flow)
        refuseAt(text_, entry.key.begin, "a key with its ':' on another line");
      locateValue(entry, entry.has_mark ? colon + 1 : entry.key.end, indent);
      end = entry.value.end;
    }
    map.end = has_braces ? closing(end, '}') : end;
  }

  void locateList(YamlPart& list) const {
    const bool has_brackets = list.is_flow;
    const int indent = list.is_flow ? -1 : columnOf(list.begin);
    std::size_t end = has_brackets ? list.begin + 1 : list.begin;
    for (YamlPart::Entry& entry : list.entries) {
      entry.has_mark = !has_brackets;
      entry.mark = has_brackets ? end : skipBlank(end);
      if (entry.has_mark && (entry.mark >= text_.size() || text_[entry.mark] != '-'))
        refuseAt(text_, end, "an element whose '-' is not found");
      std::size_t after = entry.mark + (entry.has_mark ? 1 : 0);
      if (has_brackets && entry.value.kind == Kind::kNull) after = skipBlank(skipComma(end));
      locateValue(entry, after, indent);
      end = entry.value.end;
    }
    list.end = has_brackets ? closing(end, ']') : end;
  }

  void locateValue(YamlPart::Entry& entry, std::size_t after, int indent) const {
    if (entry.value.kind == Kind::kNull) {
      locateNull(entry.value, after);
    } else {
      locate(entry.value, indent);
    }
  }

  [[nodiscard]] std::size_t skipComma(std::size_t at) const {
    at = skipBlank(at);
    return at < text_.size() && text_[at] == ',' ? at + 1 : at;
  }
  [[nodiscard]] std::size_t closing(std::size_t after, char bracket) const {
    const std::size_t at = skipBlank(skipComma(after));
    if (at >= text_.size() || text_[at] != bracket) refuseAt(text_, after, "a bracket that is not found");
    return at + 1;
  }

  std::string_view text_;
};

}  // namespace

const YamlPart::Entry* YamlPart::find(std::string_view key) const {
  const Entry* found = nullptr;
  for (const Entry& entry : entries) {
    if (kind != Kind::kMap || entry.key.scalar != key) continue;
    if (found != nullptr) throw base::InputError(fmt::format("{} is given twice", key));
    found = &entry;
  }
  return found;
}

YamlFault::YamlFault(int at_line, int at_column, const std::string& what_is_wrong)
    : InputError(fmt::format("line {}: {}", at_line, what_is_wrong)),
      line(at_line),
      column(at_column),
      message(what_is_wrong) {}

nlohmann::ordered_json plainValue(const std::string& text) {
  const YAML::Node node(text);
  double number = 0.0;
  bool flag = false;
  if (text.find_first_of("0123456789") != std::string::npos && YAML::convert<double>::decode(node, number))
    return number;
  if (YAML::convert<bool>::decode(node, flag)) return flag;
  return text;
}

YamlPart layoutOf(const std::string& text) {
  if (text.size() > kMostYamlBytes)
    throw base::InputError("larger than 1 MiB, this is no configuration file");
  bool has_document = false;
  YamlPart root;
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    LayoutBuilder builder(text);
    has_document = parser.HandleNextDocument(builder);
    root = std::move(builder).finished();
    LayoutBuilder next(text);
    if (has_document && parser.HandleNextDocument(next))
      throw base::InputError("several documents in one file: edit it as text");
  } catch (const YAML::Exception& error) {
    throw YamlFault(error.mark.line + 1, error.mark.column + 1, error.msg);
  }
  if (!has_document || root.kind == Kind::kNull) {
    root = {.kind = Kind::kMap};
    root.begin = root.end = text.size();
    return root;
  }
  EndFinder(text).locate(root, -1);
  return root;
}

nlohmann::ordered_json valueOf(const YamlPart& part) {
  using nlohmann::ordered_json;
  if (part.kind == Kind::kNull) return nullptr;
  if (part.kind == Kind::kScalar) return part.is_plain ? plainValue(part.scalar) : ordered_json(part.scalar);
  ordered_json value = part.kind == Kind::kMap ? ordered_json::object() : ordered_json::array();
  for (const YamlPart::Entry& entry : part.entries) {
    if (part.kind == Kind::kMap) {
      value[entry.key.scalar] = valueOf(entry.value);
    } else {
      value.push_back(valueOf(entry.value));
    }
  }
  return value;
}

}  // namespace kerfbench::desk
