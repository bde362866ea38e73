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

/// How a piece came off the strip.
struct CutPiece {
  double cut_s{};        ///< When the kerf had reached the strip's far edge in full depth, to 10 us.
  double near_mm{};      ///< x of the cut off its line at the strip's near edge, on the sheet; + downstream.
  double far_mm{};       ///< And at the far edge.
  double worst_mm{};     ///< Largest |x| off the line while the laser was lit inside the strip.
  double unlit_mm{};     ///< Way across the strip without energy.
  double energy_j_mm{};  ///< Mean energy per length across the strip.
};

/// The strip machine put together from the twin's own parts, as Twin does it, but for one thing: of each cut
/// only the ends are burnt into a sheet, and each piece gets a new one. So ten thousand pieces take no more
/// memory than one. (Twin keeps the whole web, 8 MB a cut, and a sheet ends 1 km from its origin.)
class StripLine {
 public:
  StripLine(const twin::MachineDescription& machine, const StripJob& job, twin::Fidelity fidelity);

  /// Runs until one more piece is off. @throws std::runtime_error if none comes off for three cycles.
  CutPiece nextPiece();
  /// Called after every step with time and the beam's place in W.
  void watch(std::function<void(double time_s, const Eigen::Vector2d& p_WQ_mm)> watcher) {
    watcher_ = std::move(watcher);
  }
  [[nodiscard]] double time_s() const;

 private:
  struct View {
    twin::BeamSpot spot;
    double web_mm{};  ///< x_W of the web's origin.
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
  int number_{1};  ///< Of the cut under way.
  bool off_{false};
  bool gate_open_{false};
  CutPiece piece_;
  std::optional<View> last_;  ///< None while nobody looks.
  std::function<void(double, const Eigen::Vector2d&)> watcher_;
};

/// What the strip is made of, and how it runs in this regime.
twin::BoardDescription stripBoard();
twin::WebDescription stripWeb(const StripJob& job);

}  // namespace kerfbench::validation
