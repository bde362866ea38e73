// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/stopwatch.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/dieline/process.h"
#include "hil/dieline/read.h"
#include "hil/inspect/inspect.h"
#include "hil/report/run_moments.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "hil/vision/spot/spot_track.h"
#include "twin/base/print_layout.h"
#include "twin/base/pulse_timing.h"

namespace kerfbench::report {

/// A picture in the results folder. Never part of the digest.
struct ReportPicture {
  std::string file;     ///< Name relative to the results folder.
  std::string caption;  ///< One line.
  std::string png{};    ///< Bytes of a picture that the page shows; empty: the page only links to it.
};

/// One value of the machine that was sampled for the run.
struct SampledValue {
  std::string name;  ///< E.g. "galvo_x.zero".
  double value{};    ///< Added to the machine file's value.
  std::string unit;
};

/// A stepper let go.
struct LostStepsNote {
  std::string axis;
  double time_s{};
  double place{};  ///< Commanded then.
  std::string unit;
  long long full_steps{};  ///< > 0: it stayed behind in the direction of +.
};

/// How far the measured spot of one cut lies from that of the model that ran along; in the machine's frame.
struct SpotParting {
  int unit{};
  int entity{};  ///< -1: none.
  double mean_x_mm{}, mean_y_mm{};
  double worst_mm{}, worst_s{};
  std::vector<double> time_s{};        ///< Time of each frame; never empty.
  std::vector<double> x_mm{}, y_mm{};  ///< Measured less the model's.
};

/// How the model ran, and what it alone knows: for people who look for a reason. Neither judged nor part of
/// the digest.
struct ModelFacts {
  std::string imperfections;  ///< "ideal", "static", "dynamic".
  std::string twin;           ///< "reference", "fast".
  std::vector<SampledValue> sampled;
  std::vector<LostStepsNote> lost_steps;  ///< Sorted by time.
  std::vector<SpotParting> partings;      ///< Where frames of a real spot camera and the model part, by cut.
};

/// "The machine lost steps: galvo_x 8 at 1.234 s (first of 3)."; empty if it lost none.
std::string lostStepsSentence(const ModelFacts& model);

/// Why the controller stopped by itself, as the check `finish` tells it; empty unless that is proven.
std::string stopSentence(const inspect::InspectionResult& result);

/// What narrows a PASS, or anything else that a verdict must not be read without.
struct Reservation {
  std::string kind;  ///< "wide_limit", "not_judged", "part_not_judged", "model_pictures",
                     ///< "calibration_age", "calibration_undated", "unsealed_recording"
  std::string text;  ///< A clause without a full stop, for people.
};

/// A file on which a run depends.
struct InputFile {
  std::string name;  ///< As seen from the scenario's folder.
  std::string sha256;
};

/// A recording or a set of pictures that was judged.
struct EvidencePart {
  std::string name;  ///< "pins", "kerf pictures", "spot frames"
  std::string sha256;
};

/// Everything a report tells of one run. Fill what is known; empty fields are left out of the pages.
struct RunReport {
  // What was run.
  std::string scenario;       ///< Name of the scenario.
  std::string scenario_path;  ///< As given on the command line.
  std::string scenario_text;  ///< The file as read, shown in full.
  std::string machine;        ///< Name of the machine.
  std::string firmware;       ///< Which release: file name, target.
  std::string
      source_id;  ///< Identity of the signal source and its configuration, e.g. "avr atmega2560 16 MHz".
  std::string repeat_command;  ///< The command line that does it again.
  std::string serial_number;   ///< What was tested, for people; no part of the digest.
  std::uint64_t seed{};
  bool provoked{};  ///< Something went wrong on purpose: judged by pins and words, no camera looked.
  ModelFacts model;
  double virtual_s{};  ///< Duration on the clock of the pins.
  std::vector<std::pair<std::string, std::string>>
      versions;  ///< "kerfbench" -> "0.1.0", "firmware sha256" -> …
  std::vector<InputFile> inputs;
  std::vector<EvidencePart> evidence;  ///< Recorded evidence; the digest binds it, read or not.
  // What was measured.
  inspect::Tolerances limits;
  std::shared_ptr<const dieline::Dieline> dieline{dieline::emptyDieline()};  ///< Never null.
  std::set<dieline::LintFinding::Kind> accepted;  ///< Faults of the drawing that the scenario accepts.
  PrintLayout print;
  vision::KerfScan kerf;
  vision::SpotTrack spot;
  std::vector<PulseTiming> pulses;
  inspect::InspectionResult result;
  /// Why the cut is bad, for people; nothing is judged by it, and it is no part of the digest.
  diagnose::Diagnosis diagnosis;
  /// The pins around the times of checks that did not pass, by time; for people.
  std::vector<Moment> moments;
  std::optional<SafeTimeline> safe;  ///< Only of a run that was to be stopped.
  ProgramLines program;
  bool unsealed{};        ///< A recording without a sum of its own was replayed.
  bool model_pictures{};  ///< The pins are real, and the pictures are the model's.
  int calibration_max_age_days{inspect::kCalibrationMaxAge_days};  ///< As the scenario has it.
  bool calibrations_undated{};  ///< Real pictures, and no day to hold the age of their calibrations against.
  std::string trace;            ///< File of the run's trace in the results folder; empty: there is none.
  // What the wall clock and the host say.
  std::string host;
  std::string finished;  ///< Date and time of the end, for people.
  std::vector<base::StageTime> timing;
  std::vector<ReportPicture> pictures;
};

/// Sentence of the most likely cause; empty if none is known.
inline std::string likelyCauseOf(const RunReport& report) {
  return report.diagnosis.causes.empty() ? std::string() : report.diagnosis.causes.front().sentence;
}
/// "Likely cause: …", a line for each cause, for a terminal; none of a run that has passed.
std::vector<std::string> diagnosisLines(const RunReport& report);

/// Limits wider than the defaults, checks that apply and were not judged, entities that were neither cut nor
/// judged, and what stands between the pictures and a real sheet. Empty for a run that is judged in full.
std::vector<Reservation> reservationsOf(const RunReport& report);
/// The same in one line, "limits wider than …; not judged: …"; empty if there are none.
std::string reservationsLine(const RunReport& report);

/// SHA-256 over the canonical JSON of evidence, measurements and verdict: equal for equal results, whatever
/// the order of the entities, the model's own knowledge, the host, the paths and the time that the run took.
/// Lengths enter rounded to 1 nm, the rest to 1e-6.
std::string digestOf(const RunReport& report);
/// SHA-256 over the bytes of all files on which the run depends, wherever they lie, and seed, twin and
/// imperfections: what a verdict was given on.
std::string inputsDigestOf(const RunReport& report);
/// Both: they take a while, and are asked for by each file of a report.
struct Digests {
  std::string results;
  std::string inputs;
};
inline Digests digestsOf(const RunReport& report) { return {digestOf(report), inputsDigestOf(report)}; }

/// verdict.json, schema_version 1.
std::string verdictJson(const RunReport& report, const Digests& digests);
/// junit.xml: one test case for each check; NOT PROVEN is a failure of type NotProven, INVALID an error.
std::string junitXml(const RunReport& report, const Digests& digests);
/// report.html: one file that needs nothing else, for the screen and for paper.
std::string htmlReport(const RunReport& report, const Digests& digests);

/// Writes verdict.json, junit.xml and report.html into the folder, each whole or not at all.
/// @throws std::system_error with the path.
void writeReports(const RunReport& report, const Digests& digests, const std::filesystem::path& folder,
                  int threads);

/// A number of a check with its unit, e.g. "0.0312 mm", "98.20 %"; "no number" for NaN.
std::string checkNumber(const inspect::Check& check, double value);

}  // namespace kerfbench::report
