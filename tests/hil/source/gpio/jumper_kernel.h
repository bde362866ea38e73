// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <set>

#include "hil/source/gpio/pulse_train.h"
#include "tests/hil/source/gpio/scripted_kernel.h"

namespace kerfbench::source {

/// A scripted kernel with a wire from the first line that is driven to the first that is read. Its settings
/// refer to the edges since the last request for inputs, from 0.
class JumperKernel : public ScriptedKernel {
 public:
  std::uint64_t latency_ns{3'000};  ///< Time from the call until the stamp; the call takes set_takes_ns.
  bool plugged{true};
  bool inverts{};
  bool stuck_high{};
  bool silent{};                     ///< True if levels follow, without interrupts.
  std::set<std::uint64_t> merged;    ///< Edges whose interrupt is counted and never reported.
  std::set<std::uint64_t> bounces;   ///< Edges that come three times.
  std::int64_t clock_offset_ns{};    ///< Offset of the stamps.
  std::uint64_t vanishes_at{~0ULL};  ///< Edge at which the chip vanishes.
  std::uint64_t beside{};            ///< Number of edges of the second line, with the first edge.

  KernelAnswer control(int fd, unsigned long request_code, void* argument) override;

 private:
  void follow(bool level, std::uint64_t called_ns);
  void tell(std::uint64_t stamp_ns, std::size_t line, bool level);

  std::uint64_t edges_{};
  bool level_{};
  std::uint32_t seqno_{};
  std::array<std::uint32_t, 2> line_seqno_{};
};

/// Drives all edges of a plan before a reader comes.
class PromptTrain final : public EdgeTrain {
 public:
  explicit PromptTrain(std::shared_ptr<JumperKernel> kernel)
      : kernel_(std::move(kernel)), line_(kernel_, "/dev/gpiochip0", {{4, "out"}}, {false}) {}
  void set(bool level) override { line_.set({{0, level}}); }
  void begin(const TrainPlan& plan) override { train_ = playTrain(*kernel_, line_, plan); }
  [[nodiscard]] bool done() const override { return true; }
  DrivenTrain end() override { return std::move(train_); }

 private:
  std::shared_ptr<JumperKernel> kernel_;
  OutputLines line_;
  DrivenTrain train_;
};

}  // namespace kerfbench::source
