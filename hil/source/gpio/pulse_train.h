// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <vector>

#include "hil/source/gpio/lag_meter.h"
#include "hil/source/gpio/output_lines.h"
#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// Edges at even distances, high first, so that an even number leaves the line low.
struct TrainPlan {
  std::uint64_t edges{};      ///< Even.
  std::uint64_t period_ns{};  ///< Time from edge to edge; > 0.
};

/// An edge that the bench made itself. The line changed between the two times (CLOCK_MONOTONIC).
struct DrivenEdge {
  std::uint64_t before_ns{};  ///< The kernel was called.
  std::uint64_t after_ns{};   ///< The call came back.
};

/// Outcome of a plan.
struct DrivenTrain {
  std::vector<DrivenEdge> edges;  ///< Fewer than planned if the line cannot be driven that fast.
  LagMeter lag;                   ///< Lag of `after_ns` behind the plan.
  /// Edges in a second from the first to the last; 0 with fewer than two.
  [[nodiscard]] double rate_hz() const;
};

/// Puts out the edges of a plan, none before its time. Where it is late it catches up at twice the rate at
/// most: a burst would test the driver, not the reader. Gives up, behind a whole pulse, when it is behind by
/// a quarter of the plan and 0.1 s. @throws GpioError as OutputLines::set().
DrivenTrain playTrain(GpioSystem& system, OutputLines& line, const TrainPlan& plan);

/// Who makes the edges of a loop-back while the bench reads them.
class EdgeTrain {
 public:
  virtual ~EdgeTrain() = default;
  /// A level, at once. @throws GpioError.
  virtual void set(bool level) = 0;
  /// Begins a plan; the one before has ended.
  virtual void begin(const TrainPlan& plan) = 0;
  [[nodiscard]] virtual bool done() const = 0;
  /// Waits for the end. @throws GpioError that ended it.
  virtual DrivenTrain end() = 0;
};

/// An output line, driven by a thread of its own just below the reader's priority: a reader that is late is
/// so by itself.
class ThreadTrain final : public EdgeTrain {
 public:
  ThreadTrain(std::shared_ptr<GpioSystem> system, OutputLines line);
  void set(bool level) override { line_.set({{0, level}}); }
  void begin(const TrainPlan& plan) override;
  [[nodiscard]] bool done() const override;
  DrivenTrain end() override { return train_.get(); }

 private:
  std::shared_ptr<GpioSystem> system_;
  OutputLines line_;
  std::future<DrivenTrain> train_;
};

}  // namespace kerfbench::source
