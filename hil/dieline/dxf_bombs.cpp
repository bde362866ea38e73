// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/dxf_bombs.h"

#include <algorithm>
#include <map>
#include <string>

#include <fmt/format.h>

#include "hil/dieline/readers.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// What a list of records unfolds to.
struct Unfolded {
  double count{};  ///< Records, those of blocks included; may be far above any integer.
  int height{};    ///< Levels of INSERT.
};

class Counter {
 public:
  Counter(const DxfFile& file, FaultList& faults) : file_(file), faults_(faults) {}

  Unfolded count(const std::vector<DxfRecord>& records, int depth) {
    Unfolded sum{static_cast<double>(records.size()), 0};
    for (const DxfRecord& record : records) {
      if (record.type() != "INSERT") continue;
      const DxfFields fields(record, faults_);
      if (fields.integer(67, 0) == 1 || fields.integer(60, 0) == 1) continue;
      const Unfolded inner = countBlock(record, fields.text(2, ""), depth);
      const DxfArray array = arrayOf(record, faults_);
      // Copies count too: an array of an empty block unfolds to nothing, but takes its time.
      sum.count += static_cast<double>(array.columns) * array.rows * (1.0 + inner.count);
      sum.height = std::max(sum.height, 1 + inner.height);
      if (sum.count > static_cast<double>(kMostEntities))
        faults_.fatal(record.line(), fmt::format("more than {} entities", kMostEntities));
    }
    return sum;
  }

 private:
  Unfolded countBlock(const DxfRecord& insert, std::string_view name, int depth) {
    const auto block = file_.blocks.find(lowered(name));
    if (block == file_.blocks.end()) return {};
    const auto known = known_.find(block->first);
    const int height = known == known_.end() ? 0 : known->second.height;
    if (depth + height >= kDeepestNesting) {
      faults_.fatal(insert.line(),
                    fmt::format("INSERT of block {} is nested deeper than {}: does it hold itself?",
                                inQuotes(name), kDeepestNesting));
    }
    if (known != known_.end()) return known->second;
    const Unfolded inner = count(block->second.records, depth + 1);
    known_.emplace(block->first, inner);
    return inner;
  }

  const DxfFile& file_;
  FaultList& faults_;
  std::map<std::string, Unfolded, std::less<>> known_;
};

}  // namespace

DxfArray arrayOf(const DxfRecord& insert, FaultList& faults) {
  const DxfFields fields(insert, faults);
  return {std::max(1, fields.integer(70, 1)), std::max(1, fields.integer(71, 1))};
}

void refuseBombs(const DxfFile& file, FaultList& faults) {
  if (Counter(file, faults).count(file.entities, 0).count > static_cast<double>(kMostEntities))
    faults.fatal(0, fmt::format("more than {} entities", kMostEntities));
}

}  // namespace kerfbench::dieline
