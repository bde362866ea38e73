// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/edge_player.h"
#include "hil/source/gpio/lag_meter.h"
#include "hil/source/gpio/line_request.h"
#include "hil/source/gpio/nanoseconds.h"
#include "hil/source/gpio/port_events.h"
#include "hil/source/gpio/real_time.h"
#include "hil/source/serial/serial_line.h"
#include "hil/source/signal_source.h"
#include "hil/source/vcd.h"

namespace kerfbench::source {

/// Sensors that depend on the controller's pins, and not on the clock alone.
constexpr bool answersToPins(Signal signal) { return signal == Signal::kLimitX || signal == Signal::kLimitY; }

struct GpioLiveOptions {
  GpioCaptureOptions in;  ///< The controller's outputs. Its time limit is the caller's affair.
  std::filesystem::path out_chip;
  std::vector<GpioWire> out;          ///< Wires of the controller's inputs; may be empty.
  std::vector<Signal> high_at_start;  ///< Signals of `out` that are high from before tick 0 on.
  /// True for a job that is started at the machine: it is over when no edge has come for in.quiet_s. False
  /// where the dialog with the controller knows when it is over.
  bool ends_when_quiet{};
  std::size_t most_edges{kMostCapturedEdges};  ///< Most edges of all inputs together; more end the run.
};

/// Record of a live run, besides the events that it handed out. Ticks are ns since tick 0.
struct GpioLiveRecord {
  std::vector<SensorEdge> sensors;  ///< Edges as they were put out, those of the start at tick 1.
  std::vector<ReceivedBytes> uart;  ///< Bytes at the times of reading.
  std::vector<std::string> problems;
  std::vector<std::string> notes;  ///< Circumstances, as in PinCapture.
  LagMeter lag;           ///< Lag of the output edges behind their plan; without those that answer to pins.
  LagMeter switch_lag;    ///< Lag of edges that answer to pins; kHoldBack_ns of it is by design.
  std::uint64_t edges{};  ///< Number of edges that came in.
};

/// A controller's real pins while a model runs along: its outputs are read, its inputs are driven, its UART
/// may be a serial line. Tick 0 is the first advance(); a tick is 1 ns of CLOCK_MONOTONIC.
///
/// Time. An edge is stamped in its interrupt but may be read later, by up to EdgeOrder::kHold_ns. So
/// advance(until) comes back at until + kHoldBack_ns, and by then all that happened up to `until` is known:
/// the watermark is true, and an edge which comes with a stamp at or before it spoils the run. It follows:
///
/// - A sensor that depends on nothing but the clock (encoder and print mark of a belt that the line drives)
///   is to be driven ahead: an edge for tick t must be here before the clock is there, which is when the
///   watermark is t - kHoldBack_ns, less a quantum and what the model computes meanwhile. drive() takes ticks
///   as far ahead as one likes. Then its lag is what this computer's timers and the call cost.
/// - A sensor that depends on pins (a limit switch that the gantry runs onto) is known kHoldBack_ns after it
///   happened, and put out at once: that late. To guess it earlier from speed would trip switches that a
///   controller brakes in front of.
///
/// While it waits it puts out edges at their times and reads what comes; between two calls of advance() it
/// does neither, so whatever the caller computes there makes edges late, which is measured. Nothing is put
/// out early.
class GpioLiveSource final : public SignalSource {
 public:
  static constexpr TickRate kRate = kNanoseconds;
  /// Time slightly longer than EdgeOrder's wait, so that it has decided about a missing number.
  static constexpr std::uint64_t kHoldBack_ns = EdgeOrder::kHold_ns + 1'000'000;
  /// Lateness of the caller at which the run is given up: edges would be lost in the kernel's buffer.
  static constexpr std::uint64_t kHopeless_ns = 250'000'000;

  /// `uart` may be null. @throws GpioError if lines cannot be had, std::invalid_argument for wires that `map`
  /// does not have.
  GpioLiveSource(const GpioLiveOptions& options, const SignalMap& map, std::shared_ptr<GpioSystem> system,
                 std::unique_ptr<SerialLine> uart);

  [[nodiscard]] SourceInfo info() const override;
  /// kEnded when the pins are quiet (ends_when_quiet); kLost when chip or serial line fail, more edges came
  /// than a recording holds, or the caller is hopelessly late.
  Stop advance(Tick until, Batch& batch) override;
  /// Unlike other sources: calls come in order of tick for each pin alone, and a tick that is past is put out
  /// at once. Pins without a line are passed over.
  void drive(PinId pin, bool level, Tick at) override;
  void uartWrite(std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::string message() const override { return message_; }

  /// Worst lag so far of edges that do not answer to pins.
  [[nodiscard]] std::uint64_t worstLag_ns();

  /// Record after the last advance(), with one more look at the lines. Edges and bytes after `end` are left
  /// out.
  GpioLiveRecord finish(Tick end);

 private:
  void begin();
  void runTo(std::uint64_t goal_ns);
  bool readEdges(std::uint64_t timeout_ns);
  void drain(std::uint64_t until_ns);
  void pumpUart();
  /// Time of the last bytes that the caller has.
  [[nodiscard]] Tick uartReceived() const {
    return handed_bytes_ == 0 ? 0 : received_[handed_bytes_ - 1].tick;
  }
  void lookAgain(std::vector<std::string>& problems);
  Stop stop(Stop why, std::string message);
  [[nodiscard]] std::uint64_t nsOf(Tick tick) const { return origin_ns_ + tick; }

  GpioLiveOptions options_;
  std::shared_ptr<GpioSystem> system_;
  /// Edges that were put out; declared before real_time_, which locks their memory.
  std::vector<PlayedEdge> played_;
  std::size_t looked_at_{};  ///< Number of entries of played_ that worst_lag_ns_ is of.
  std::uint64_t worst_lag_ns_{};
  RealTime real_time_;
  std::unique_ptr<SerialLine> uart_;
  LineRequest request_;
  std::optional<EdgePlayer> player_;
  std::map<PinId, std::size_t> out_line_;  ///< Line of each pin that is driven.
  struct EarlyEdge {
    std::size_t line{};
    bool level{};
    Tick at{};
  };
  std::vector<EarlyEdge> before_start_;

  bool begun_{};
  std::uint64_t origin_ns_{};
  std::uint64_t begin_ns_{};
  std::optional<EdgeOrder> order_;
  PortEvents ports_;
  std::vector<PinEvent> start_events_;
  std::vector<std::string> start_problems_;
  std::vector<KernelEdge> read_;
  std::vector<LineEdge> edges_;
  std::vector<ReceivedBytes> received_;
  std::size_t handed_bytes_{};  ///< Number of entries of received_ that the caller has.
  std::uint64_t last_edge_ns_{};
  std::size_t came_{};  ///< Edges.
  Tick watermark_{};
  Stop stop_{Stop::kReached};
  std::string message_;
};

}  // namespace kerfbench::source
