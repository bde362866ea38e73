// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/markdown.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "hil/base/text.h"

namespace kerfbench::desk {
namespace {

std::string element(std::string_view name, const std::string& content) {
  std::string text = "<";
  text += name;
  text += '>';
  text += content;
  text += "</";
  text += name;
  return text + '>';
}

/// Text between a mark at `at` and the next one of the same, or nothing where there is none.
std::optional<std::string_view> enclosed(std::string_view text, std::size_t at, std::string_view mark) {
  const std::size_t begin = at + mark.size();
  const std::size_t end = text.find(mark, begin);
  if (text.substr(at, mark.size()) != mark || end == std::string_view::npos || end == begin)
    return std::nullopt;
  return text.substr(begin, end - begin);
}

/// Words of a link "[words](address)" at `at`, and the length of all of it.
struct Link {
  std::string_view words;
  std::size_t length{};
};
std::optional<Link> linkAt(std::string_view text, std::size_t at) {
  if (text[at] != '[') return std::nullopt;
  const std::size_t middle = text.find("](", at);
  if (middle == std::string_view::npos) return std::nullopt;
  const std::size_t end = text.find(')', middle);
  if (end == std::string_view::npos) return std::nullopt;
  return Link{text.substr(at + 1, middle - at - 1), end + 1 - at};
}

/// Blocks of a text, one after the other.
class BlockWriter {
 public:
  void line(std::string_view raw) {
    if (raw.starts_with("```")) {
      flush();
      is_fenced_ = !is_fenced_;
      return;
    }
    if (is_fenced_ || (raw.starts_with("    ") && (code_.empty() ? words_.empty() : true))) {
      code_ += std::string(is_fenced_ ? raw : raw.substr(4)) + "\n";
      return;
    }
    const std::string_view text = base::trimmed(raw);
    if (text.empty() || text.starts_with("|") || text.starts_with("#")) return flush();
    if (text.starts_with("- ")) {
      if (!words_.empty() && !in_list_) flush();
      in_list_ = true;
      endItem();
      words_ = text.substr(2);
      return;
    }
    words_ += (words_.empty() ? "" : " ") + std::string(text);
  }

  std::string finished() {
    flush();
    return std::move(html_);
  }

 private:
  void endItem() {
    if (!words_.empty()) items_ += element("li", markdownInline(words_));
    words_.clear();
  }
  void flush() {
    if (!code_.empty()) html_ += element("pre", base::escapeHtml(code_));
    code_.clear();
    if (in_list_) {
      endItem();
      html_ += element("ul", items_);
      items_.clear();
      in_list_ = false;
    } else if (!words_.empty()) {
      html_ += element("p", markdownInline(words_));
      words_.clear();
    }
  }

  std::string html_, words_, items_, code_;
  bool in_list_{}, is_fenced_{};
};

}  // namespace

std::string markdownInline(std::string_view text) {
  std::string html;
  std::string plain;
  const auto add = [&](const std::string& more) {
    html += base::escapeHtml(plain) + more;
    plain.clear();
  };
  for (std::size_t at = 0; at < text.size();) {
    if (const auto code = enclosed(text, at, "`")) {
      add(element("code", base::escapeHtml(std::string(*code))));
      at += code->size() + 2;
    } else if (const auto strong = enclosed(text, at, "**")) {
      add(element("strong", markdownInline(*strong)));
      at += strong->size() + 4;
    } else if (const auto emphasis = enclosed(text, at, "*")) {
      add(element("em", markdownInline(*emphasis)));
      at += emphasis->size() + 2;
    } else if (const auto link = linkAt(text, at)) {
      add(markdownInline(link->words));
      at += link->length;
    } else {
      plain += text[at++];
    }
  }
  add({});
  return html;
}

std::string markdownBlocks(std::string_view text) {
  BlockWriter writer;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    writer.line(text.substr(from, to - from));
    from = to + 1;
  }
  return writer.finished();
}

}  // namespace kerfbench::desk
