// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace kerfbench::serve {

/// Address of another bench, as its `kerfbench serve` has printed it.
struct BenchAddress {
  std::string host;  ///< Without brackets.
  int port{};
  std::string token;
};
/// "http://192.168.0.7:8080/?token=…". @throws base::InputError that names the text.
BenchAddress benchAddressFrom(const std::string& text);

/// Other benches, asked by this server, so that a browser shows all of them on one page and still asks nobody
/// else. What they say is data: it is bounded, and only the fields of GET /api/station are passed on. May be
/// used by several threads.
class Neighbours {
 public:
  static constexpr std::size_t kMost = 32;
  static constexpr std::size_t kMostBytes = 1U << 20U;         ///< An answer beyond it is no answer.
  static constexpr std::chrono::milliseconds kPatience{3000};  ///< For each, all in all.
  static constexpr std::chrono::milliseconds kFresh{1000};     ///< So long an answer is not asked for again.

  /// @throws base::InputError for more than kMost.
  explicit Neighbours(std::vector<BenchAddress> addresses);
  ~Neighbours();
  Neighbours(const Neighbours&) = delete;
  Neighbours& operator=(const Neighbours&) = delete;

  /// Each with its "address" (without the token); then as station(), or with "problem", a sentence.
  [[nodiscard]] nlohmann::json json();

 private:
  class Neighbour;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Neighbour>> all_;
  std::string answered_;
  std::optional<std::chrono::steady_clock::time_point> asked_;
};

}  // namespace kerfbench::serve
