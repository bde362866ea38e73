// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/inspect/inspect.h"

namespace kerfbench::inspect::testing {

/// Ids of the entities of the small carton that SyntheticRun cuts.
enum SmallCarton { kBottom = 0, kRight, kTop, kLeft, kHole, kCreaseLine, kPerforationLine, kNote };

/// Takes a station's kerf away.
void unburn(vision::Caliper& caliper);

/// Evidence of a flawless run, made by hand: a 60 x 40 mm carton on a belt at 200 mm/s, cut at 300 mm/s, with
/// a little noise from a fixed sequence. Tests then falsify the fields whose checks they test.
struct SyntheticRun {
  SyntheticRun();
  SyntheticRun(const SyntheticRun& other);
  SyntheticRun& operator=(const SyntheticRun&) = delete;

  dieline::Dieline dieline;
  Evidence evidence;  ///< Evidence; its dieline is `dieline`.
  Tolerances limits;

  vision::EntityKerf& kerf(int unit, int entity);
  /// Length of the perforated line.
  static constexpr double kPerforation_mm = 35.0;
  /// Cuts of a pattern that begins with one, along the perforated line.
  static std::vector<std::pair<double, double>> cutsOf(double cut_mm, double bridge_mm);
  /// Cuts the perforated line of a unit anew.
  void perforate(int unit, const std::vector<std::pair<double, double>>& cuts_mm);
  /// Moves each spot while it follows `entity` of `unit`: the shift in mm along W from the time since its
  /// first frame.
  void shiftSpot(int unit, int entity, const std::function<Eigen::Vector2d(double)>& shift_mm);
  /// Index of the first frame at this time or later.
  [[nodiscard]] std::size_t frameAt(double time_s) const;
  /// Appends a second pass of the spot along an entity.
  void followAgain(int unit, int entity);
  [[nodiscard]] InspectionResult inspected() const { return inspect(evidence, limits); }

 private:
  void addKerf();
  void addFrames();
  void follow(int unit, int entity);
  void addFrame(bool lit, int unit, const Eigen::Vector2d& p_S_mm);
  double noise();

  struct Stretch {
    int unit, entity;
    std::size_t begin, end;
  };
  std::vector<Stretch> stretches_;
  std::uint32_t noise_state_{1};
};

/// Check of this name. @throws std::out_of_range if there is none.
const Check& checkOf(const InspectionResult& result, std::string_view name);
/// The check of that name that was not judged. @throws std::out_of_range if there is none.
const Unjudged& unjudgedOf(const InspectionResult& result, std::string_view name);
bool hasCheck(const InspectionResult& result, std::string_view name);

}  // namespace kerfbench::inspect::testing
