// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/diagnose/evidence.h"
#include "hil/inspect/evidence/pin_evidence.h"
#include "hil/judge/asked_path.h"
#include "hil/judge/program_path.h"

namespace kerfbench::judge {

/// Where the pulses led the beam over the sheet while the gate was open, and which piece of the program that
/// was.
class TimedCuts {
 public:
  struct Cut {
    int unit{};
    const ProgramPath::Piece* piece{};  ///< Null: not known.
    bool reversed{};                    ///< The piece runs the other way: units in turn.
    double on_s{}, off_s{};
    std::vector<double> time_s;
    std::vector<Eigen::Vector2d> p_S_mm;
  };
  struct Options {
    int units{1};
    bool alternate{};  ///< Odd units are cut in reverse.
  };
  /// All arguments must outlive it.
  TimedCuts(const AskedPath& asked, const SheetPath& sheet, const ProgramPath& program,
            const std::vector<inspect::GateInterval>& gates, const Options& options);

  [[nodiscard]] const std::vector<Cut>& cuts() const { return cuts_; }
  /// Each opening of the gate is one piece of the program.
  [[nodiscard]] bool paired() const { return paired_; }

  struct Passing {
    double time_s{};
    double offset_mm{};
  };
  /// When and how far aside the beam was led past a place of the drawing; nullopt: it was not.
  [[nodiscard]] std::optional<Passing> passing(int unit, int entity, const Eigen::Vector2d& p_S_mm,
                                               const Eigen::Vector2d& normal, double reach_mm) const;

 private:
  void sample(const AskedPath& asked, const SheetPath& sheet, Cut& cut) const;

  std::vector<Cut> cuts_;
  const ProgramPath& program_;
  bool paired_{};
  Options options_;
};

}  // namespace kerfbench::judge
