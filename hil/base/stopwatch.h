// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::base {

/// Time that one stage of a run took on the wall clock. Never part of the digest.
struct StageTime {
  std::string stage;
  double wall_s{};
};

/// Says where the wall time of a run went. Nothing that is judged depends on it.
class Stopwatch {
 public:
  Stopwatch() : last_(Clock::now()), start_(last_) {}
  /// The time since the last call went into `stage`.
  void lap(const std::string& stage) {
    const auto now = Clock::now();
    stages_.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }
  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }
  [[nodiscard]] double total_s() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_;
  Clock::time_point start_;
  std::vector<StageTime> stages_;
};

}  // namespace kerfbench::base
