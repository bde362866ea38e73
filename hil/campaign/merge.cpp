// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/merge.h"

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"

namespace kerfbench::campaign {
namespace {

/// Reads the records of all runs and gives each line to `take`.
template <typename Take>
Merged gathered(const Prepared& prepared, std::size_t runs, const Take& take) {
  const RecordFolder folder = prepared.records();
  Merged merged;
  for (std::size_t i = 0; i < runs; ++i) {
    const RecordFolder::Found found = folder.find(i);
    if (!found.damage.empty()) merged.damaged.push_back(found.damage);
    if (found.line.empty()) {
      merged.missing.push_back(i);
      continue;
    }
    merged.records.push_back(recordFrom(found.line));
    take(found.line + "\n");
  }
  return merged;
}

}  // namespace

Merged readRecords(const Prepared& prepared, std::size_t runs) {
  return gathered(prepared, runs, [](const std::string&) {});
}

Merged merge(const Prepared& prepared, std::size_t runs, bool partial) {
  base::AtomicFile file(prepared.folder / "results.jsonl");
  base::Sha256 sum;
  Merged merged = gathered(prepared, runs, [&](const std::string& line) {
    file.write(line);
    sum.add(line);
  });
  if (!merged.isWhole() && !partial) return merged;
  file.commit();
  merged.digest = sum.digest();
  base::writeFileAtomically(prepared.folder / "results.sha256",
                            fmt::format("{}  results.jsonl\n", merged.digest));
  return merged;
}

std::string rangesOf(const std::vector<std::size_t>& numbers) {
  constexpr std::size_t kMostRanges = 10;
  std::string text;
  std::size_t ranges = 0;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i;
    while (end + 1 < numbers.size() && numbers[end + 1] == numbers[end] + 1) ++end;
    if (++ranges > kMostRanges) return text + fmt::format(" and {} more", numbers.size() - i);
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
    if (end > i) text += fmt::format("-{}", numbers[end]);
    i = end + 1;
  }
  return text;
}

}  // namespace kerfbench::campaign
