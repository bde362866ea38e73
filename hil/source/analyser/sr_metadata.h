// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::source {

/// Metadata of a session file's samples.
struct SrMetadata {
  std::uint64_t samplerate_hz{};
  std::size_t sample_bytes{};
  std::string samples_name;  ///< "logic-1": the part of this name, or those with "-1", "-2", … behind it.
  std::vector<std::pair<unsigned, std::string>> channels;  ///< Bit of a sample, name.
};

/// Reads the metadata; faults are appended to `faults`, each a sentence.
SrMetadata readSrMetadata(const std::string& text, std::vector<std::string>& faults);

std::string srMetadataText(const SrMetadata& metadata);

}  // namespace kerfbench::source
