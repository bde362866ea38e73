// SPDX-License-Identifier: Apache-2.0
// What was asked of a file, where it stands, and all that is wrong with it.
#include "hil/base/yaml_faults.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "hil/base/near_word.h"
#include "hil/base/text.h"
#include "hil/base/yaml_node.h"

namespace kerfbench::base {
namespace {

constexpr std::size_t kMostTold = 200;

}  // namespace

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
  const std::string message = faultsText(faults());
  if (!message.empty()) throw ConfigError(message);
}

std::string faultsText(const std::vector<YamlReader::Fault>& faults) {
  std::string message;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const YamlReader::Fault& fault = faults[i];
    if (i == kMostTold) {
      message += fmt::format("\n{}: {} faults more", fault.path.string(), faults.size() - kMostTold);
      break;
    }
    message += fmt::format("{}{}:{}: {}{}{}", message.empty() ? "" : "\n", fault.path.string(), fault.line,
                           fault.key, fault.key.empty() ? "" : ": ", fault.message);
  }
  return message;
}

}  // namespace kerfbench::base
