// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Parts of the zip that a session file is, but for its samples.
namespace kerfbench::source::sr_parts {

inline constexpr const char* kVersion = "version";
inline constexpr const char* kMetadata = "metadata";
/// Ours: a problem a line (see vcd_words.h).
inline constexpr const char* kProblems = "kerfbench-problems";

}  // namespace kerfbench::source::sr_parts
