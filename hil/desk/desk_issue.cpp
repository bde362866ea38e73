// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/desk_issue.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "hil/base/input_error.h"
#include "hil/desk/scenario_edit.h"
#include "hil/desk/yaml_layout.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

bool isFile(std::string_view name) {
  std::error_code error;
  return name.starts_with('/') && fs::exists(fs::path(name), error);
}

/// Begin of a line as "file:12: " or "file: ".
struct Head {
  fs::path file;
  int line{};
  std::size_t length{};
};

/// The first ": " or ":12: " before which a file's name stands; names may hold colons.
Head headOf(std::string_view text, const fs::path& scenario) {
  for (std::size_t at = text.find(':'); at != std::string_view::npos; at = text.find(':', at + 1)) {
    int line = 0;
    std::size_t end = at + 1;
    const auto [stop, error] = std::from_chars(text.data() + end, text.data() + text.size(), line);
    if (error == std::errc()) end = static_cast<std::size_t>(stop - text.data());
    const bool numbered = error == std::errc() && end < text.size() && text[end] == ':';
    if (numbered) ++end;
    if (end >= text.size() || text[end] != ' ') continue;
    const std::string_view name = text.substr(0, at);
    if (name != scenario.native() && !isFile(name)) continue;
    return {fs::path(name), numbered ? line : 0, end + 1};
  }
  return {};
}

/// The key that begins a message: "belt.speed_mm_s: …"; empty where none does.
std::string keyBefore(std::string_view message) {
  const std::size_t end = message.find(": ");
  if (end == std::string_view::npos) return {};
  const std::string_view key = message.substr(0, end);
  const auto isPart = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '[' || c == ']';
  };
  const bool is_key =
      !key.empty() && key.front() >= 'a' && key.front() <= 'z' && std::ranges::all_of(key, isPart);
  return is_key ? std::string(key) : std::string();
}

void placeByKey(DeskIssue& issue, const ScenarioText& scenario) {
  if (!issue.file.empty() || issue.line > 0 || issue.key.empty()) return;
  const TextPlace place = placeOfKey(scenario.text, issue.key);
  issue.line = place.line;
  issue.column = place.column;
}

}  // namespace

std::vector<DeskIssue> issuesOf(const std::vector<base::YamlReader::Fault>& faults,
                                const ScenarioText& scenario) {
  std::vector<DeskIssue> issues;
  for (const base::YamlReader::Fault& fault : faults) {
    DeskIssue issue{.file = fault.path,
                    .line = fault.line,
                    .column = fault.column,
                    .key = fault.key,
                    .message = fault.message};
    if (fault.path == scenario.file) issue.file.clear();
    issues.push_back(std::move(issue));
  }
  return issues;
}

std::vector<DeskIssue> issuesIn(std::string_view what, const ScenarioText& scenario) {
  std::vector<DeskIssue> issues;
  for (std::size_t from = 0; from < what.size();) {
    const std::size_t to = std::min(what.find('\n', from), what.size());
    const std::string_view line = what.substr(from, to - from);
    from = to + 1;
    const Head head = headOf(line, scenario.file);
    if (head.file.empty() && !issues.empty()) {
      issues.back().message += "\n" + std::string(line);
      continue;
    }
    DeskIssue issue{.file = head.file, .line = head.line, .message = std::string(line.substr(head.length))};
    if (head.file == scenario.file) issue.file.clear();
    issue.key = keyBefore(issue.message);
    if (!issue.key.empty()) issue.message = issue.message.substr(issue.key.size() + 2);
    placeByKey(issue, scenario);
    issues.push_back(std::move(issue));
  }
  return issues;
}

TextPlace placeOfKey(const std::string& text, std::string_view key) {
  try {
    const YamlPart root = layoutOf(text);
    const YamlPart* holder = &root;
    const YamlPart::Entry* nearest = nullptr;
    for (const std::string& name : keyPathFrom(key)) {
      const YamlPart::Entry* const entry = holder->find(name);
      if (entry == nullptr) break;
      nearest = entry;
      holder = &entry->value;
    }
    if (nearest == nullptr) return {};
    const std::size_t at = nearest->key.begin;
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const auto begin = before == std::string::npos ? 0 : before + 1;
    return {
        1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')),
        1 + static_cast<int>(at - begin)};
  } catch (const base::InputError&) {
  }
  return {};
}

json jsonOf(const std::vector<DeskIssue>& issues, const DeskRequest& request) {
  json list = json::array();
  for (const DeskIssue& issue : issues) {
    const std::string file = issue.file.empty() ? std::string()
                             : request.name_of  ? request.name_of(issue.file)
                                                : issue.file.string();
    list.push_back({{"file", file},
                    {"line", issue.line},
                    {"column", issue.column},
                    {"severity", issue.is_error ? "error" : "warning"},
                    {"key", issue.key},
                    {"message", issue.message}});
  }
  return list;
}

}  // namespace kerfbench::desk
