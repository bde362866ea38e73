// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tests/validation/strip_controller.h"
#include "twin/cutter/machine_model.h"
#include "twin/cutter/pin_decoder.h"
#include "twin/laser/laser.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::validation {

inline constexpr TickRate kStripRate{1, 16'000'000};

/// Result of cutting a piece off the strip.
struct CutPiece {
  double cut_s{};  ///< Time at which the kerf had reached the strip's far edge in full depth, to 10 us.
  /// Distance x of the cut from its line at the strip's near edge, on the sheet; + downstream.
  double near_mm{};
  double far_mm{};       ///< Distance x of the cut from its line at the far edge.
  double worst_mm{};     ///< Largest |x| off the line while the laser was lit inside the strip.
  double unlit_mm{};     ///< Length across the strip without energy.
  double energy_j_mm{};  ///< Mean energy per length across the strip.
};

/// The strip machine composed of the twin's own parts, as Twin does it, with one difference: only the ends of
/// each cut are burnt into a sheet, and each piece gets a new one. So ten thousand pieces take no more memory
/// than one. (Twin keeps the whole web, 8 MB a cut, and a sheet ends 1 km from its origin.)
class StripLine {
 public:
  StripLine(const twin::MachineDescription& machine, const StripJob& job, twin::Fidelity fidelity);

  /// Runs until one more piece is off. @throws std::runtime_error if none comes off for three cycles.
  CutPiece nextPiece();
  /// Sets a watcher, which is called after every step with time and the beam's place in W.
  void watch(std::function<void(double time_s, const Eigen::Vector2d& p_WQ_mm)> watcher) {
    watcher_ = std::move(watcher);
  }
  [[nodiscard]] double time_s() const;

 private:
  struct View {
    twin::BeamSpot spot;
    double web_mm{};  ///< Place x_W of the web's origin.
  };

  void readPins();
  void step();
  double emit(double begin_s);
  void follow(const View& before, const View& now, double energy_j);
  [[nodiscard]] View view() const;

  twin::MachineDescription machine_;
  StripJob job_;
  StripController controller_;
  twin::MachineModel model_;
  twin::Laser laser_;
  twin::BoardDescription board_;
  twin::Sheet sheet_;
  twin::PinDecoder pins_;
  std::vector<PinEvent> events_;
  Tick now_{0};
  std::uint64_t steps_{0};
  int number_{1};  ///< Number of the cut under way.
  bool off_{false};
  bool gate_open_{false};
  CutPiece piece_;
  std::optional<View> last_;  ///< Last view; none while it is not needed.
  std::function<void(double, const Eigen::Vector2d&)> watcher_;
};

/// Material of the strip, and its web in this regime.
twin::BoardDescription stripBoard();
twin::WebDescription stripWeb(const StripJob& job);

}  // namespace kerfbench::validation
