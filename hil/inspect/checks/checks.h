// SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of inspect(). Private to hil/inspect and its tests.

#include <functional>
#include <string>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/inspect/deviation/worst_deviation.h"
#include "hil/inspect/edges/edges.h"
#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/places.h"
#include "hil/inspect/evidence/results.h"
#include "hil/inspect/evidence/spot_association.h"
#include "hil/inspect/verdict/tolerances.h"

namespace kerfbench::inspect::checks {

/// Peak brightness of a back-lit kerf: from here on the board is open.
inline constexpr double kOpenBrightness = 0.75;
/// From here on something was burnt at all.
inline constexpr double kBurntBrightness = 0.10;
/// From this share of the light of the cuts on a crease is through for certain. Below it, and above
/// kOpenBrightness, what is left of a board that scatters little may be as bright.
inline constexpr double kSurelyOpenShare = 0.9;

/// Ends closer than this are drawn to meet.
inline constexpr double kMeet_mm = 0.02;

/// The entity of the dieline with this id. @throws std::logic_error if there is none.
const dieline::Entity& entityOf(const Evidence& evidence, int id);

/// Burnt, but not through: a crease or a half-cut.
bool isPartial(dieline::Process process);

bool isOpen(const vision::Caliper& caliper);
/// True where the station is burnt as the process asks. Near a joint other kerfs take part in the profile, so
/// there only the light counts, and a crease may look open.
bool isBurntAsAsked(const vision::Caliper& caliper, dieline::Process process);

/// Stations that coverage counts: an open curve's outermost pieces are the business of the laser_timing
/// check.
std::vector<const vision::Caliper*> innerStations(const vision::EntityKerf& kerf, const dieline::Curve& curve,
                                                  double end_mm);

/// A piece of a line between two of its stations.
struct Stretch {
  double from_mm{}, to_mm{};  ///< First and last station of the piece.
  double length_mm{};         ///< What the light of its stations and of those beside them says; 0: none.
};
/// The longest piece whose stations are all `missing`. A caliper averages over 2 kWindowHalfMm of its line: a
/// piece shorter than a quarter of that leaves no station missing, and is not seen.
Stretch longestStretch(const std::vector<const vision::Caliper*>& stations,
                       const std::function<bool(const vision::Caliper&)>& missing);
/// True where nothing, or of a cut too little, was burnt.
bool isUncut(const vision::Caliper& caliper, dieline::Process process);
/// Among the stations that coverage counts.
Stretch longestUncut(const Evidence& evidence, const vision::EntityKerf& kerf, const Tolerances& limits);
/// The longest piece of longestUncut()'s kind that shows nothing at all. A groove that is dimmer than
/// kBurntBrightness but keeps its place from station to station was burnt: too little, or its floor is
/// scorched as dark as the board.
Stretch longestBlank(const Evidence& evidence, const vision::EntityKerf& kerf, const Tolerances& limits);
/// The order of a crease's or half-cut's depth; nullptr where the scenario has none.
const Tolerances::OrderedDepth* orderOf(dieline::Process process, const Tolerances& limits);
/// A length that is at least the one and at most the other.
struct Bounds {
  double least_mm{};
  double most_mm{};

  /// Whether a check should name this one of the two: what exceeds its limit for certain comes first.
  [[nodiscard]] bool isWorseThan(const Bounds& other, double limit_mm) const;
  /// Makes it the value of a check, with half the station pitch as the guard at either bound.
  void decideIn(Check& check, double pitch_mm) const;
};
/// Largest distance of two neighbouring stations, mm.
double pitchOf(const vision::EntityKerf& kerf);

/// Share of the inner stations that are burnt as the process asks.
double coverageOf(const Evidence& evidence, const vision::EntityKerf& kerf, const Tolerances& limits);
/// Deviation of all lines with its uncertainty; of an edgeScan(), with its sides.
DeviationResult measureLines(const Evidence& evidence, const Tolerances& limits,
                             const EdgeSides* edges = nullptr);
/// One result for each scanned entity, in the order of the scan; passes is still NaN.
std::vector<EntityResult> measureEntities(const Evidence& evidence, const Tolerances& limits,
                                          const DeviationResult& deviations);
/// Corners and ends, in the order of the scan.
std::vector<JointResult> measureJoints(const Evidence& evidence);
/// True when less than half of what was to be cut is cut there: the beam was on another path, and what a
/// caliper finds may be any line's kerf.
bool isElsewhere(const Evidence& evidence);
/// True when next to nothing was burnt on any unit: then offsets and widths are moot.
bool isBlank(const std::vector<EntityResult>& entities);
/// Readings, calibrations, times and limits that are no numbers; what was not measured may be NaN, and says
/// so.
std::vector<std::string> numberProblems(const Evidence& evidence, const Tolerances& limits);
/// Holes in the kerf evidence, one sentence each.
std::vector<std::string> kerfProblems(const Evidence& evidence);

// Each check is decided and explained, or says why it judges nothing of this job.
Check pathCheck(const Evidence& evidence, const Tolerances& limits, const DeviationResult& deviations);
Check coverageCheck(const Evidence& evidence, const Tolerances& limits,
                    const std::vector<EntityResult>& entities);
/// Bridges of a cut, or of cuts that hang together, as a share of their length; the longest is coverage's.
Finding bridgesCheck(const Evidence& evidence, const Tolerances& limits);
Finding depthCheck(const Evidence& evidence, const Tolerances& limits);
/// Creases and half-cuts are as deep everywhere, by the light that comes through.
Finding evenDepthCheck(const Evidence& evidence, const Tolerances& limits);
/// The depth of creases and half-cuts against what was ordered.
Finding orderedDepthCheck(const Evidence& evidence, const Tolerances& limits);
/// Energy per length of the marks, by power meter and spot camera.
Finding lineEnergyCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit);
Finding perforationCheck(const Evidence& evidence, const Tolerances& limits);
Check kerfWidthCheck(const Evidence& evidence, const Tolerances& limits,
                     const std::vector<EntityResult>& entities);
/// The width of cuts against the one that was ordered.
Finding orderedWidthCheck(const Evidence& evidence, const Tolerances& limits,
                          const std::vector<EntityResult>& entities);
Check strayCheck(const Evidence& evidence, const Tolerances& limits);
Finding laserTimingCheck(const Evidence& evidence, const Tolerances& limits,
                         const std::vector<EntityResult>& entities, const EdgeSides* edges = nullptr);
/// Corners by their distance from the dieline, free ends by how far they are too short or too long, closures
/// by their gap; all against the limit of the path. An overlap at a closure lies on the dieline and is no
/// deviation.
Finding jointsCheck(const Evidence& evidence, const Tolerances& limits,
                    const std::vector<JointResult>& joints, const std::vector<EntityResult>& entities);
Check laserGateCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& followed);
/// The laser's gate after the interlock opened, by the pins alone: off within kLaserOff_s, as in a safe
/// state.
Finding interlockCheck(const Evidence& evidence);
Check pulseTimingCheck(const Evidence& evidence);
/// What the controller reports of its place and of its end, held against the pins.
Finding accountFinding(const Evidence& evidence);
Finding finishFinding(const Evidence& evidence);
/// A check of a report that the run does not have.
Unjudged absentReport(const Evidence& evidence, const Check& check);

}  // namespace kerfbench::inspect::checks
