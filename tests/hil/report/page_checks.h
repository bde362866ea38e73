// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <regex>
#include <string>
#include <string_view>

namespace kerfbench::report::test {

/// Whether an element of the page has this id.
inline bool hasAnchor(const std::string& html, const std::string& id) {
  for (const std::string& written : {" id='" + id + "'", " id=" + id + " ", " id=" + id + ">"})
    if (html.find(written) != std::string::npos) return true;
  return false;
}

/// References of a page to elsewhere, scripts with attributes, links to anchors that it does not have, and
/// references other than pictures inside it and `beside`, the files next to it, separated by blanks. Empty
/// for a self-contained page.
inline std::string outsideReferences(const std::string& html, std::string_view beside = {}) {
  std::string found;
  for (const char* outside : {"http:", "https:", "<script ", "<link", "@import", "url("})
    if (html.find(outside) != std::string::npos) found += std::string(outside) + " ";
  const std::string files = " " + std::string(beside) + " ";
  static const std::regex kReference("(src|href)='([^']*)'");
  for (auto it = std::sregex_iterator(html.begin(), html.end(), kReference); it != std::sregex_iterator();
       ++it) {
    const std::string target = (*it)[2];
    if (target.starts_with("#") && hasAnchor(html, target.substr(1))) continue;
    if (!target.starts_with("data:image/png;base64,") && files.find(" " + target + " ") == std::string::npos)
      found += target.substr(0, 80) + " ";
  }
  return found;
}

/// First value that is no number, with the text before it.
inline std::string numberFaults(const std::string& html) {
  static const std::regex kFault(R"re([^a-z](nan|inf)[^a-z])re");
  std::smatch match;
  if (!std::regex_search(html, match, kFault)) return {};
  const auto at = static_cast<std::size_t>(match.position());
  return html.substr(at - std::min<std::size_t>(at, 60), 70);
}

/// Elements that must be closed and are closed less often than opened.
inline std::string unclosedElements(const std::string& html) {
  std::string found;
  for (const char* name :
       {"html",   "body",       "main", "header", "section", "div", "table", "tbody", "thead", "svg",
        "figure", "figcaption", "ul",   "ol",     "details", "g",   "p",     "title", "style", "article",
        "nav",    "dl",         "a",    "label",  "script",  "h1",  "h2",    "h3"}) {
    const auto count = [&](const std::string& pattern) {
      const std::regex tag(pattern);
      return std::distance(std::sregex_iterator(html.begin(), html.end(), tag), std::sregex_iterator());
    };
    if (count(std::string("<") + name + "[ >]") != count(std::string("</") + name + ">"))
      found += std::string(name) + " ";
  }
  return found;
}

}  // namespace kerfbench::report::test
