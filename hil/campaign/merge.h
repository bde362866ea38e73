// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/campaign/identity.h"
#include "hil/campaign/record.h"

namespace kerfbench::campaign {

/// The records of a campaign, brought together.
struct Merged {
  std::vector<Record> records;       ///< Ordered by index.
  std::vector<std::size_t> missing;  ///< Runs without a record.
  std::vector<std::string>
      damaged;         ///< Records that cannot be used; each names its file. Their runs are missing.
  std::string digest;  ///< SHA-256 of results.jsonl; empty unless it was written.

  [[nodiscard]] bool isWhole() const { return missing.empty(); }
};

/// Reads the records of all runs.
Merged readRecords(const Prepared& prepared, std::size_t runs);

/// Reads them, and if none is missing, or `partial` says that some may be, writes results.jsonl, a line for
/// each run in order, and results.sha256, its sum as sha256sum has it. The bytes are the same by however many
/// shards, threads and computers the runs were made.
/// @throws std::system_error.
Merged merge(const Prepared& prepared, std::size_t runs, bool partial);

/// "0-3, 7, 9-11": a list of ascending numbers for people, cut off after some.
std::string rangesOf(const std::vector<std::size_t>& numbers);

}  // namespace kerfbench::campaign
