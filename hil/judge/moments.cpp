// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/moments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/job/job.h"
#include "hil/inspect/evidence/spot_association.h"

namespace kerfbench::judge {
namespace {

/// Times of checks closer than this are one moment.
constexpr double kSameMoment_s = 1e-4;
constexpr std::size_t kMostMoments = 12;
constexpr double kProgramChord_mm = 0.5;
/// A place farther from the program than this is not on it.
constexpr double kOnProgram_mm = inspect::kSearch_mm;

/// The lines of a program as chords, by entity.
class ProgramPlaces {
 public:
  explicit ProgramPlaces(const std::string& gcode) {
    std::vector<planner::Segment> path;
    try {
      path = planner::readGcode(gcode);
    } catch (const planner::PlanError&) {
      return;
    }
    for (const planner::Segment& segment : path)
      if (!segment.jump && segment.z > 0.0 && segment.line > 0) add(segment);
  }

  [[nodiscard]] bool empty() const { return chords_.empty(); }
  /// Line of the program that leads along an entity nearest to a place; 0: none does.
  [[nodiscard]] int lineAt(int entity, const Eigen::Vector2d& p_S_mm) const {
    // A program that does not name its entities has all of them under -1.
    const auto own = chords_.find(chords_.contains(-1) ? -1 : entity);
    if (own == chords_.end()) return 0;
    double least_mm = kOnProgram_mm;
    int line = 0;
    for (const Chord& chord : own->second) {
      const double away_mm = chord.distanceTo(p_S_mm);
      if (away_mm >= least_mm) continue;
      least_mm = away_mm;
      line = chord.line;
    }
    return line;
  }

 private:
  struct Chord {
    Eigen::Vector2d from_mm, to_mm;
    int line{};
    [[nodiscard]] double distanceTo(const Eigen::Vector2d& p_mm) const {
      const Eigen::Vector2d way = to_mm - from_mm;
      const double square = way.squaredNorm();
      const double share = square > 0.0 ? std::clamp((p_mm - from_mm).dot(way) / square, 0.0, 1.0) : 0.0;
      return (from_mm + share * way - p_mm).norm();
    }
  };

  void add(const planner::Segment& segment) {
    const double length_mm = segment.lengthMm();
    const int parts =
        segment.isArc() ? std::max(1, static_cast<int>(std::ceil(length_mm / kProgramChord_mm))) : 1;
    Eigen::Vector2d before = segment.start_mm;
    for (int i = 1; i <= parts; ++i) {
      const Eigen::Vector2d after = segment.at(length_mm * i / parts);
      chords_[segment.entity].push_back({before, after, segment.line});
      before = after;
    }
  }

  std::map<int, std::vector<Chord>> chords_;
};

void addProgram(const std::string& gcode, report::RunReport& report) {
  const ProgramPlaces places(gcode);
  if (places.empty()) return;
  std::set<int> named;
  for (inspect::CutResult& cut : report.result.cuts) {
    for (inspect::CutFrame& frame : cut.track) {
      frame.program_line = places.lineAt(frame.entity, frame.p_S_mm);
      if (frame.program_line > 0) named.insert(frame.program_line);
    }
  }
  std::istringstream text(gcode);
  int number = 0;
  for (std::string line; std::getline(text, line);)
    if (named.contains(++number)) report.program.emplace(number, std::move(line));
}

/// What the spot was seen on within a span.
std::vector<report::FollowedSpan> followedWithin(const std::vector<inspect::CutResult>& cuts, double from_s,
                                                 double to_s) {
  std::vector<report::FollowedSpan> spans;
  for (const inspect::CutResult& cut : cuts) {
    bool is_new = true;  // A cut is a run of frames that follow each other.
    for (const inspect::CutFrame& frame : cut.track) {
      if (frame.time_s < from_s || frame.time_s > to_s) continue;
      if (!is_new && spans.back().entity == frame.entity && spans.back().line == frame.program_line) {
        spans.back().to_s = frame.time_s;
        continue;
      }
      if (!is_new) spans.back().to_s = frame.time_s;
      spans.push_back({frame.time_s, frame.time_s, cut.unit, frame.entity, frame.program_line});
      is_new = false;
    }
  }
  std::ranges::sort(spans, {}, &report::FollowedSpan::from_s);
  return spans;
}

/// Moments of the checks that did not pass, by time, without their pins.
std::vector<report::Moment> momentsOf(const inspect::InspectionResult& result, double end_s) {
  std::vector<const inspect::Check*> checks;
  for (const inspect::Check& check : result.checks)
    if (check.verdict != inspect::Verdict::kPass && check.where.hasTime() && check.where.time_s >= 0.0 &&
        check.where.time_s <= end_s)
      checks.push_back(&check);
  std::ranges::stable_sort(checks, {}, [](const inspect::Check* c) { return c->where.time_s; });
  std::vector<report::Moment> moments;
  for (const inspect::Check* check : checks) {
    if (!moments.empty() && check->where.time_s - moments.back().time_s <= kSameMoment_s) {
      moments.back().checks.push_back(check->name);
      continue;
    }
    if (moments.size() == kMostMoments) break;
    const double time_s = check->where.time_s;
    moments.push_back({{check->name},
                       time_s,
                       std::max(time_s - kMomentAround_s, 0.0),
                       std::min(time_s + kMomentAround_s, end_s),
                       {},
                       {}});
  }
  return moments;
}

/// Fills the traces of moments from the events of a recording, read once.
class TraceFiller {
 public:
  TraceFiller(const source::PinRecording& recording, const SignalMap& signals,
              std::vector<report::Moment>& moments)
      : recording_(recording), signals_(signals), moments_(moments) {
    for (std::size_t s = 0; s < kSignalCount; ++s) {
      const auto signal = static_cast<Signal>(s);
      if (signals.hasOwnWire(signal)) wires_.push_back(signal);
    }
    moves_.resize(wires_.size());
    for (report::Moment& moment : moments_)
      for (const Signal signal : wires_) moment.pins.push_back({std::string(signalName(signal)), false, {}});
  }

  void fill() {
    for (const PinEvent event : recording_.outputs) {
      for (std::size_t w = 0; w < wires_.size(); ++w) {
        const auto pin = *signals_.pin(wires_[w]);
        if (isSensor(wires_[w]) || pin.port != event.port || (event.changed >> pin.bit & 1U) == 0) continue;
        take(w, recording_.rate.seconds(event.tick), (event.level >> pin.bit & 1U) != 0);
      }
    }
    for (std::size_t i = 0; i < recording_.sensors.size(); ++i) {
      const SensorEdge edge = recording_.sensors[i];
      const auto wire = std::ranges::find(wires_, edge.signal);
      if (wire != wires_.end())
        take(static_cast<std::size_t>(wire - wires_.begin()), recording_.rate.seconds(edge.tick), edge.level);
    }
    for (report::Moment& moment : moments_)
      std::erase_if(moment.pins, [this](const report::PinTrace& pin) { return isIdle(pin); });
  }

 private:
  void take(std::size_t wire, double time_s, bool level) {
    moves_[wire] = true;
    for (report::Moment& moment : moments_) {
      report::PinTrace& trace = moment.pins[wire];
      if (time_s < moment.from_s) {
        trace.level = level;
      } else if (time_s <= moment.to_s) {
        trace.toggle_s.push_back(time_s);
      }
    }
  }
  /// Axes that the whole run does not move, and enables, limits and the like that do nothing within the
  /// span.
  [[nodiscard]] bool isIdle(const report::PinTrace& pin) const {
    if (!pin.toggle_s.empty()) return false;
    const auto wire = std::ranges::find(wires_, pin.name, &signalName);
    if (!moves_[static_cast<std::size_t>(wire - wires_.begin())]) return true;
    return !pin.name.ends_with("_pul") && !pin.name.ends_with("_dir") && !pin.name.starts_with("laser_") &&
           !pin.name.starts_with("encoder") && pin.name != "interlock";
  }

  const source::PinRecording& recording_;
  const SignalMap& signals_;
  std::vector<report::Moment>& moments_;
  std::vector<Signal> wires_;
  std::vector<bool> moves_;  ///< Wires that have an edge in the whole recording.
};

}  // namespace

void addMoments(const source::PinRecording& recording, const SignalMap& signals, const std::string& gcode,
                report::RunReport& report) {
  if (!gcode.empty()) addProgram(gcode, report);
  report.moments = momentsOf(report.result, recording.rate.seconds(recording.end));
  if (report.moments.empty()) return;
  TraceFiller(recording, signals, report.moments).fill();
  for (report::Moment& moment : report.moments)
    moment.followed = followedWithin(report.result.cuts, moment.from_s, moment.to_s);
}

report::SafeTimeline safeTimeline(const inspect::SafeStateEvidence& evidence) {
  const inspect::SafeStateDemand& demand = evidence.demand;
  report::SafeTimeline safe;
  safe.cause = demand.cause;
  safe.cause_s = demand.cause_s;
  safe.known_s = demand.cause_s + demand.window_s;
  safe.laser_due_s = safe.known_s + inspect::kLaserOff_s;
  safe.axes_due_s = safe.laser_due_s + demand.stop_s;
  safe.word_due_s = safe.axes_due_s + demand.report_s;
  for (const inspect::GateInterval& gate : evidence.gates)
    if (std::isnan(safe.gate_off_s) || gate.off_s > safe.gate_off_s) safe.gate_off_s = gate.off_s;
  if (evidence.last_pulse_s >= 0.0) safe.last_pulse_s = evidence.last_pulse_s;
  const double early_s = demand.window_s > 0.0 ? inspect::kInferredEarly_s : 0.0;
  const auto word = std::ranges::find_if(evidence.reports, [&](const inspect::ControllerState& report) {
    return report.stopped && report.time_s >= demand.cause_s - early_s;
  });
  if (word == evidence.reports.end()) return safe;
  safe.word = word->fault;
  safe.word_s = word->time_s;
  return safe;
}

}  // namespace kerfbench::judge
