// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "hil/source/analyser/analyser.h"
#include "hil/source/child_process.h"

namespace kerfbench::source {

/// The bytes to and from a child; tests script them.
class ByteLink {
 public:
  using Clock = ChildProcess::Clock;
  virtual ~ByteLink() = default;
  virtual ChildProcess::Io write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) = 0;
  virtual ChildProcess::Io read(std::span<std::uint8_t> into, Clock::time_point deadline) = 0;
  /// End of the child and its last words, for people.
  virtual std::string farewell() = 0;
};

/// Speaks analyser_stream.h with a child that `start` starts for each request (which may throw
/// std::system_error).
std::shared_ptr<AnalyserSystem> linkedAnalysers(std::function<std::unique_ptr<ByteLink>()> start);

}  // namespace kerfbench::source
