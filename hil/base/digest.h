// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "hil/base/progress.h"

namespace kerfbench::base {

/// SHA-256 of bytes that come one after the other.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  /// Sum of all bytes so far, as 64 lower-case hex digits. More may follow.
  [[nodiscard]] std::string digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// SHA-256 as 64 lower-case hex digits.
std::string sha256(std::string_view bytes);
/// XXH3 of 128 bits as 32 lower-case hex digits: a hundred times quicker, for data that nobody forges.
std::string checksum(std::span<const std::uint8_t> bytes);
/// Reads the file in pieces. @throws std::system_error if the file cannot be read.
std::string sha256File(const std::filesystem::path& path, const ProgressFn& progress = {});

}  // namespace kerfbench::base
