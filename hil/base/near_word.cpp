// SPDX-License-Identifier: Apache-2.0
#include "hil/base/near_word.h"

#include <algorithm>
#include <cstddef>

#include "hil/base/text.h"

namespace kerfbench::base {
namespace {

constexpr std::size_t kLongest = 64;  // A word that a person types.

/// Least number of changes that make `b` of `a`, where neighbours are exchanged at most once.
std::size_t changesBetween(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      const std::size_t changed = a[i - 1] == b[j - 1] ? 0 : 1;
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + changed});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

}  // namespace

std::string nearWord(std::string_view typed, const std::vector<std::string>& words) {
  if (typed.empty() || typed.size() > kLongest) return {};
  const std::string small = lowered(typed);
  const std::string* nearest = nullptr;
  std::size_t least = 0;
  for (const std::string& word : words) {
    if (word.size() > kLongest) continue;
    const std::size_t changes = changesBetween(small, lowered(word));
    const std::size_t letters = std::min(typed.size(), word.size());
    const std::size_t most = letters < 6 ? 1 : letters / 3;
    if (changes > most || (nearest != nullptr && changes >= least)) continue;
    nearest = &word;
    least = changes;
  }
  return nearest == nullptr ? std::string() : *nearest;
}

std::string didYouMean(std::string_view typed, const std::vector<std::string>& words) {
  const std::string near = nearWord(typed, words);
  return near.empty() ? std::string() : " Did you mean " + near + "?";
}

}  // namespace kerfbench::base
