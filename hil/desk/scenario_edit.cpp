// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/scenario_edit.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/desk/json_text.h"
#include "hil/desk/yaml_layout.h"
#include "hil/desk/yaml_words.h"

namespace kerfbench::desk {
namespace {

using nlohmann::ordered_json;
using PartKind = YamlPart::Kind;

constexpr std::size_t kMostEdits = 10'000;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

std::string inWords(const std::vector<std::string>& path) { return fmt::format("{}", fmt::join(path, ".")); }

std::optional<std::size_t> indexFrom(std::string_view name) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
  if (error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  return index;
}

/// One edit of one text.
class TextEdit {
 public:
  TextEdit(const std::string& text, const KeyEdit& edit)
      : text_(text), root_(layoutOf(text)), edit_(edit), line_end_(lineEndOf(text)) {
    if (root_.kind != PartKind::kMap) throw base::InputError("the text is no mapping of keys");
  }

  std::string made() {
    walk();
    if (edit_.value.is_null()) {
      if (depth() == edit_.path.size()) remove();
    } else if (depth() == edit_.path.size()) {
      replace(*way_.back().entry, edit_.value);
    } else {
      insert();
    }
    return std::move(text_);
  }

 private:
  /// An entry on the way to the key, in what holds it.
  struct Step {
    const YamlPart* holder{};
    const YamlPart::Entry* entry{};
    std::size_t index{};  ///< Place of the entry among the holder's.
  };

  static std::string lineEndOf(const std::string& text) {
    const std::size_t at = text.find('\n');
    return at != std::string::npos && at > 0 && text[at - 1] == '\r' ? "\r\n" : "\n";
  }

  /// How many names of the path are there.
  [[nodiscard]] std::size_t depth() const { return way_.size(); }
  /// What holds the next name of the path.
  [[nodiscard]] const YamlPart& reached() const { return way_.empty() ? root_ : way_.back().entry->value; }

  void walk() {
    for (const std::string& name : edit_.path) {
      const YamlPart& holder = reached();
      std::size_t index = holder.entries.size();
      if (holder.kind == PartKind::kMap) {
        const YamlPart::Entry* const found = holder.find(name);
        if (found != nullptr) index = static_cast<std::size_t>(found - holder.entries.data());
      } else if (holder.kind == PartKind::kList) {
        const auto wanted = indexFrom(name);
        if (!wanted || *wanted > holder.entries.size())
          refuse(fmt::format("the list has {} elements", holder.entries.size()));
        index = *wanted;
      } else if (holder.kind == PartKind::kScalar && !edit_.value.is_null()) {
        refuse(fmt::format("{} is '{}' here and has no keys", inWords(path(depth())),
                           base::printable(holder.scalar)));
      }
      if (index >= holder.entries.size()) return;
      way_.push_back({&holder, &holder.entries[index], index});
    }
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw base::InputError(fmt::format("{}: {}", inWords(edit_.path), why));
  }
  [[nodiscard]] std::vector<std::string> path(std::size_t names) const {
    return {edit_.path.begin(), edit_.path.begin() + static_cast<std::ptrdiff_t>(names)};
  }

  [[nodiscard]] std::size_t lineBegin(std::size_t at) const {
    const std::size_t end = at == 0 ? std::string::npos : text_.rfind('\n', at - 1);
    return end == std::string::npos ? 0 : end + 1;
  }
  /// Behind the line's end.
  [[nodiscard]] std::size_t nextLine(std::size_t at) const {
    const std::size_t end = text_.find('\n', at);
    return end == std::string::npos ? text_.size() : end + 1;
  }
  /// At the line's end, '\r' left out.
  [[nodiscard]] std::size_t lineStop(std::size_t at) const {
    std::size_t end = std::min(text_.find('\n', at), text_.size());
    if (end > at && text_[end - 1] == '\r') --end;
    return end;
  }
  [[nodiscard]] bool isFirstOnLine(std::size_t at) const {
    return text_.find_first_not_of(" \t", lineBegin(at)) == at;
  }
  [[nodiscard]] int columnOf(std::size_t at) const { return static_cast<int>(at - lineBegin(at)); }
  [[nodiscard]] static std::size_t beginOf(const YamlPart& holder, const YamlPart::Entry& entry) {
    if (holder.kind == PartKind::kMap) return entry.key.begin;
    return entry.has_mark ? entry.mark : entry.value.begin;
  }
  [[nodiscard]] bool isWithinBraces() const {
    return std::ranges::any_of(way_, [](const Step& step) { return step.holder->is_flow; });
  }

  /// Puts a value in the place of an entry's.
  void replace(const YamlPart::Entry& entry, const ordered_json& value) {
    const YamlPart& old = entry.value;
    const bool in_lines = needsLines(value) && !isWithinBraces() && entry.has_mark && !isElement(entry);
    const char first =
        old.kind == PartKind::kScalar && !old.is_plain && !old.is_block_text ? text_[old.begin] : '\0';
    const std::string words = in_lines ? "" : yamlInline(value, value.is_string() ? first : '\0');
    const std::size_t after = entry.has_mark ? entry.mark + 1 : entry.value.end;
    const bool on_this_line = lineBegin(old.begin) == lineBegin(entry.mark);
    if (!in_lines && on_this_line && old.end > old.begin) {
      text_.replace(old.begin, old.end - old.begin, words);
      return;
    }
    // What is in lines below, or not there: the new value goes behind the mark, or in lines below itself.
    std::string mark = entry.has_mark ? "" : ":";
    if (old.end > old.begin) {
      std::size_t from = on_this_line ? old.begin : lineStop(after);
      if (on_this_line)
        while (from > after && text_[from - 1] == ' ') --from;
      text_.erase(from, old.end - from);
    }
    if (in_lines) {
      addLine(nextLine(after), yamlLines(value, columnOf(entry.key.begin) + 2, line_end_));
    } else {
      text_.insert(after, mark + " " + words);
    }
  }
  [[nodiscard]] bool isElement(const YamlPart::Entry& entry) const {
    return std::ranges::any_of(
        way_, [&](const Step& step) { return step.entry == &entry && step.holder->kind == PartKind::kList; });
  }

  /// Inserts whole lines at the begin of a line, or at the end of a text without a last line's end.
  void addLine(std::size_t at, std::string lines) {
    if (at > 0 && text_[at - 1] != '\n') {
      lines = line_end_ + lines;
      lines.resize(lines.size() - line_end_.size());
    }
    text_.insert(at, lines);
  }

  /// The rest of the path as mappings around the value.
  [[nodiscard]] ordered_json nested(std::size_t from) const {
    ordered_json value = edit_.value;
    for (std::size_t i = edit_.path.size(); i-- > from;) {
      ordered_json holder = ordered_json::object();
      holder[edit_.path[i]] = std::move(value);
      value = std::move(holder);
    }
    return value;
  }

  void insert() {
    const YamlPart& holder = reached();
    if (holder.kind == PartKind::kNull) {
      replace(*way_.back().entry, nested(depth()));
    } else if (holder.is_flow) {
      insertInBraces(holder);
    } else if (holder.kind == PartKind::kList) {
      const YamlPart::Entry& last = holder.entries.back();
      addLine(nextLine(last.value.end), std::string(static_cast<std::size_t>(columnOf(last.mark)), ' ') +
                                            "- " + yamlInline(nested(depth() + 1)) + line_end_);
    } else {
      const bool is_empty = holder.entries.empty();
      const std::size_t at = is_empty ? text_.size() : nextLine(holder.entries.back().value.end);
      const int indent = is_empty ? 0 : columnOf(holder.entries.front().key.begin);
      addLine(at, yamlLines(nested(depth()), indent, line_end_));
    }
  }

  void insertInBraces(const YamlPart& holder) {
    std::string words = yamlInline(holder.kind == PartKind::kList ? nested(depth() + 1) : nested(depth()));
    if (holder.kind == PartKind::kMap) words = words.substr(1, words.size() - 2);
    if (holder.entries.empty()) {
      text_.insert(holder.begin + 1, words);
    } else {
      text_.insert(holder.entries.back().value.end, ", " + words);
    }
  }

  void remove() {
    // With the last key of a section the section goes.
    while (way_.size() > 1 && way_.back().holder->entries.size() == 1 &&
           way_.back().holder->kind == PartKind::kMap && way_[way_.size() - 2].holder->kind == PartKind::kMap)
      way_.pop_back();
    const auto [holder, entry, index] = way_.back();
    if (holder->entries.size() == 1 && way_.size() > 1) {
      // The only one of a list, or of a list's element: what is left is empty.
      text_.replace(holder->begin, holder->end - holder->begin, holder->kind == PartKind::kMap ? "{}" : "[]");
    } else if (holder->is_flow) {
      removeInBraces(*holder, index);
    } else {
      removeLines(*holder, index);
    }
  }

  void removeLines(const YamlPart& holder, std::size_t index) {
    const std::size_t begin = beginOf(holder, holder.entries[index]);
    const std::size_t end = std::max(holder.entries[index].value.end, holder.entries[index].mark + 1);
    if (isFirstOnLine(begin)) {
      text_.erase(lineBegin(begin), nextLine(end) - lineBegin(begin));
      return;
    }
    // Behind the '-' of an element: the next key takes its place.
    if (index + 1 == holder.entries.size()) refuse("it cannot be taken out of its line");
    const std::size_t next = beginOf(holder, holder.entries[index + 1]);
    if (text_.substr(end, next - end).find('#') != std::string::npos)
      refuse("a comment stands between it and the next key");
    text_.erase(begin, next - begin);
  }

  void removeInBraces(const YamlPart& holder, std::size_t index) {
    const YamlPart::Entry& entry = holder.entries[index];
    std::size_t begin = beginOf(holder, entry);
    std::size_t end = std::max(entry.value.end, entry.key.end);
    if (index + 1 < holder.entries.size()) {
      const std::size_t comma = text_.find(',', end);
      end = std::min(text_.find_first_not_of(" \t", comma + 1), text_.size());
    } else if (index > 0) {
      const YamlPart::Entry& before = holder.entries[index - 1];
      const std::size_t from = std::max(before.value.end, before.key.end);
      if (text_.substr(from, begin - from).find('#') == std::string::npos) begin = from;
    }
    // A line of its own goes whole.
    const bool is_line = isFirstOnLine(begin) && end == lineStop(end);
    if (is_line) {
      begin = lineBegin(begin);
      end = nextLine(end);
    }
    text_.erase(begin, end - begin);
  }

  std::string text_;
  YamlPart root_;
  const KeyEdit& edit_;
  std::string line_end_;
  std::vector<Step> way_;
};

/// The change as it is to be, in the tree; false where the path does not lead anywhere.
bool changeTree(ordered_json& at, const KeyEdit& edit, std::size_t depth) {
  const std::string& name = edit.path[depth];
  const bool is_last = depth + 1 == edit.path.size();
  if (at.is_array()) {
    const std::size_t index = indexFrom(name).value_or(at.size());
    if (index >= at.size() && edit.value.is_null()) return false;
    if (is_last && edit.value.is_null()) {
      at.erase(index);
      return true;
    }
    if (index >= at.size()) at.push_back(nullptr);
    if (is_last) {
      at[index] = edit.value;
      return true;
    }
    return changeTree(at[index], edit, depth + 1);
  }
  if (at.is_null() && !edit.value.is_null()) at = ordered_json::object();
  if (!at.is_object() || (edit.value.is_null() && !at.contains(name))) return false;
  if (is_last && edit.value.is_null()) {
    at.erase(name);
    return true;
  }
  if (is_last) {
    at[name] = edit.value;
    return true;
  }
  const bool changed = changeTree(at[name], edit, depth + 1);
  if (edit.value.is_null() && at[name].is_object() && at[name].empty() && changed) at.erase(name);
  return changed;
}

ordered_json treeOf(const std::string& text) {
  ordered_json tree = valueOf(layoutOf(text));
  return tree.is_null() ? ordered_json::object() : tree;
}

std::string editedOnce(const std::string& text, const KeyEdit& edit) {
  ordered_json wanted = treeOf(text);
  changeTree(wanted, edit, 0);
  std::string made = TextEdit(text, edit).made();
  bool is_good = false;
  try {
    is_good = treeOf(made) == wanted;
  } catch (const base::InputError&) {
  }
  if (!is_good)
    throw base::InputError(inWords(edit.path) + ": cannot be changed here alone: edit this file as text");
  return made;
}

KeyEdit editFrom(const nlohmann::ordered_json& entry) {
  KeyEdit edit;
  const auto path = entry.find("path");
  if (!entry.is_object() || path == entry.end() || !entry.contains("value"))
    throw base::InputError("set: each has a path and a value");
  if (path->is_string()) {
    edit.path = keyPathFrom(path->get<std::string>());
  } else if (path->is_array()) {
    for (const auto& name : *path) {
      if (!name.is_string()) throw base::InputError("set: a path is a text, or a list of texts");
      edit.path.push_back(name.get<std::string>());
    }
  }
  if (edit.path.empty()) throw base::InputError("set: a path is a text, or a list of texts");
  edit.value = entry["value"];
  return edit;
}

}  // namespace

std::vector<std::string> keyPathFrom(std::string_view words) {
  std::vector<std::string> path{""};
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == '.') {
      path.emplace_back();
    } else if (words[i] == '[') {
      const std::size_t end = words.find(']', i);
      const std::string_view index =
          end == std::string_view::npos ? std::string_view() : words.substr(i + 1, end - i - 1);
      if (!indexFrom(index)) throw base::InputError(base::inQuotes(words) + " is no path of keys");
      path.emplace_back(index);
      i = end;
    } else {
      path.back() += words[i];
    }
  }
  for (const std::string& name : path)
    if (name.empty()) throw base::InputError(base::inQuotes(words) + " is no path of keys");
  return path;
}

std::string edited(const std::string& text, const std::vector<KeyEdit>& edits) {
  if (edits.size() > kMostEdits) throw base::InputError(fmt::format("more than {} edits", kMostEdits));
  const bool has_mark = text.starts_with(kByteOrderMark);
  std::string result = has_mark ? text.substr(kByteOrderMark.size()) : text;
  for (const KeyEdit& edit : edits) {
    if (edit.path.empty()) throw base::InputError("an edit without a path");
    result = editedOnce(result, edit);
  }
  return has_mark ? std::string(kByteOrderMark) + result : result;
}

ordered_json valueIn(const std::string& text, std::string_view path) {
  const YamlPart root = layoutOf(text);
  const YamlPart* at = &root;
  for (const std::string& name : keyPathFrom(path)) {
    const YamlPart::Entry* const entry = at->find(name);
    if (entry == nullptr) return nullptr;
    at = &entry->value;
  }
  return valueOf(*at);
}

std::string editJson(const std::string& body) {
  const ordered_json request = ordered_json::parse(body, nullptr, false);
  if (!request.is_object() || !request.contains("text") || !request["text"].is_string() ||
      !request.contains("set") || !request["set"].is_array())
    throw base::InputError("expected {\"text\": …, \"set\": [{\"path\": …, \"value\": …}]}");
  std::vector<KeyEdit> edits;
  for (const auto& entry : request["set"]) edits.push_back(editFrom(entry));
  return jsonText({{"text", edited(request["text"].get<std::string>(), edits)}});
}

}  // namespace kerfbench::desk
