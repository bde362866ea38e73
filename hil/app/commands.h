// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/calibrate/head/head_parameters.h"
#include "hil/gauge/gauge.h"

namespace kerfbench::hil {

/// See captureCommand().
struct CaptureCommandOptions {
  std::filesystem::path scenario;
  std::filesystem::path out;           ///< Folder; empty: results/NAME-capture.
  std::optional<double> time_limit_s;  ///< Real; instead of the scenario's.
  bool session{};                      ///< pins.sr beside pins.vcd.
  bool quiet{};
  std::filesystem::path bin_dir;
};

/// What all commands that judge have in common. See DESIGN: the program.
struct CommonOptions {
  std::filesystem::path results_dir{"results"};
  std::optional<std::uint64_t> seed;         ///< Instead of the scenario's.
  std::optional<double> time_limit_s;        ///< Virtual; instead of the scenario's.
  std::optional<std::string> imperfections;  ///< Name of a preset; instead of the scenario's.
  std::optional<std::string> twin;           ///< Name of a fidelity; instead of the scenario's.
  int jobs{1};
  bool quiet{};
  bool timing{};
  bool pictures{true};            ///< Of the machine, in the report.
  std::filesystem::path bin_dir;  ///< Where kerfbench and its children are.
  std::string command_line;       ///< As typed, for the report.
};

/// A picture of a machine, see showCommand().
struct ShowOptions {
  std::filesystem::path machine;   ///< May be empty where the scenario names it.
  std::filesystem::path scenario;  ///< Empty: the machine at rest.
  std::vector<double> at_s;        ///< Virtual times; none: the middle of the longest cut.
  std::filesystem::path out;       ///< Empty: named after machine or scenario, in the current folder.
  int width_px{1280};
  int height_px{800};
  std::string view{"overall"};  ///< overall, head, sheet.
  bool quiet{};
  std::filesystem::path bin_dir;
};

/// See calibrateCameraCommand() and calibrateTargetCommand().
struct CalibrateOptions {
  std::filesystem::path machine;
  std::string camera;                        ///< spot, kerf.
  std::vector<std::filesystem::path> views;  ///< Pictures, or folders of them; none: drawn by the twin.
  std::filesystem::path target;              ///< Its description; empty: the one that fits the camera.
  std::vector<double> origin_mm{0.0, 0.0};   ///< Of the target in the first view.
  double turn_deg{};
  std::string date;
  std::uint64_t seed{1};
  int tilted{9};  ///< Views of the twin besides the first.
  double max_rms_px{0.05};
  std::filesystem::path out;  ///< Empty: where the machine file looks for it.
  std::filesystem::path
      picture;  ///< Residual map; empty: named after machine and camera, in the current folder.
  std::filesystem::path save_views;  ///< Folder for the twin's pictures; empty: they are not kept.
  int columns{}, rows{};             ///< Of a target to print; 0: as fits the camera.
  double square_mm{};
  int jobs{1};
  bool quiet{};
};

/// See calibrateHeadCommand().
struct HeadCalibrateOptions {
  std::filesystem::path machine;
  std::filesystem::path results_dir{"results/head"};  ///< Of this calibration alone; it goes on from there.
  std::vector<int> grids{3, 9, 17};
  int verify{400};
  double limit_mm{0.010};
  double unmodelled_share{HeadTolerances{}.unmodelled_share};
  std::uint64_t seed{1};
  std::string imperfections{"static"};
  std::string twin{"fast"};
  std::string date;           ///< Empty: the kerf camera's calibration's.
  std::filesystem::path out;  ///< Empty: correction.csv in the results.
  bool keep_pictures{};
  bool by_hand{};                  ///< People cut the sheets and photograph them.
  std::filesystem::path image;     ///< By hand: the controller's release; empty: the native one for galvos.
  std::filesystem::path job;       ///< Of a sheet that was cut; empty: the twin cuts.
  std::filesystem::path pictures;  ///< Of that sheet: a folder with tiles.yaml.
  std::filesystem::path table;  ///< That it was cut with; empty: the one that the machine file names, if any.
  int jobs{1};
  bool quiet{};
  std::filesystem::path bin_dir;
  std::string command_line;
};

/// What gauge can be asked for.
inline constexpr std::array kGaugeStudies{"verdicts", "coverage", "type1", "grr", "stillness"};

/// See gaugeCommand().
struct GaugeCommandOptions {
  std::filesystem::path machine{"fixtures/machines/two-mirror.yaml"};
  std::filesystem::path results_dir{"results"};
  GaugeOptions gauge;
  std::vector<std::string> studies;  ///< Names of kGaugeStudies; none: all.
  std::string the_case;              ///< Name of one case to repeat; empty: all.
  std::string command_line;          ///< As typed, for the report.
  bool quiet{};
};

/// What doctor is to measure on lines that are wired to each other.
struct BenchOptions {
  bool wanted{};
  std::string loop_back;  ///< "OUT=IN": numbers or names of lines.
  std::string chip;       ///< IN's, by path, name or label; empty: the only one.
  std::string out_chip;   ///< OUT's; empty: `chip`.
  std::string beside;     ///< A free line of `chip`, read besides; empty: the first free input.
  std::vector<double> rates_hz{200, 1'000, 2'000, 5'000, 10'000, 20'000, 40'000, 80'000, 160'000};
  double seconds{1.0};  ///< For each rate.
};

/// See doctorCommand().
struct DoctorOptions {
  std::filesystem::path scenario;  ///< Empty: what this computer has, and no more.
  bool json{};
  BenchOptions bench;
  std::filesystem::path bin_dir;
};

/// See recordFramesCommand().
struct RecordFramesOptions {
  std::filesystem::path scenario;
  std::filesystem::path out;
  std::uint64_t frames{};     ///< 0: until it ends, by time or by itself.
  double time_limit_s{60.0};  ///< From the first frame on.
  double wait_s{10.0};        ///< For the first frame.
  bool quiet{};
  std::filesystem::path bin_dir;
};

inline constexpr int kExitBroken = 2;    ///< The bench itself broke.
inline constexpr int kExitUsage = 64;    ///< Wrong command line.
inline constexpr int kExitInput = 65;    ///< Bad input file.
inline constexpr int kExitWaiting = 75;  ///< Somebody has to do something; then again.

/// Runs every scenario; returns the worst exit code (INVALID before FAIL before NOT PROVEN before PASS).
int runCommand(const std::vector<std::filesystem::path>& scenarios, const CommonOptions& options);
/// Judges a recording of pins as if it were live. `frames`: of a real spot camera; empty: those beside the
/// pins.
int replayCommand(const std::filesystem::path& recording, const std::filesystem::path& scenario,
                  const std::filesystem::path& frames, const CommonOptions& options);
/// Records the spot camera that a scenario names. Returns 0; 3 if fewer frames came than were asked for, or
/// none; kExitInput.
int recordFramesCommand(const RecordFramesOptions& options);
/// Records the real pins that a scenario names to a folder, without model and verdict. Returns 0, 3 if the
/// recording cannot be trusted, kExitBroken if the session file alone could not be written, or kExitInput.
int captureCommand(const CaptureCommandOptions& options);
/// Checks a scenario, a machine or a dieline. Returns 0, or kExitInput when something is wrong with a file.
int lintCommand(const std::vector<std::filesystem::path>& files, const CommonOptions& options);
/// What hardware this computer has and what is wrong with it, on standard output. Returns 0; with a scenario
/// 1 if something that it needs is missing, or kExitInput. With `bench` it measures instead: 1 if the
/// loop-back cannot be measured, or loses edges at its lowest rate.
int doctorCommand(const DoctorOptions& options);
/// Draws a machine at rest, or as a run of the scenario has it at given times (by the fast twin). Several
/// times make several files, with the time in the name. Returns 0, kExitUsage, kExitInput, or kExitBroken
/// when POV-Ray is missing or fails.
int showCommand(const ShowOptions& options);

/// Calibrates a camera from views of a target; writes the calibration and a residual map. Returns 0, or
/// kExitInput with everything that is wrong with the files or views on standard error, and nothing written.
int calibrateCameraCommand(const CalibrateOptions& options);
/// Writes a target to print (SVG) and its description beside it (YAML). Returns 0 or kExitInput.
int calibrateTargetCommand(const CalibrateOptions& options);

/// Calibrates a scan head by marks that the twin cuts, or by the pictures of a sheet that is cut; writes the
/// controller's correction table, what was measured, and a report. Returns 0; 1 if the table is not good
/// enough, 3 for marks or pictures that cannot be trusted, kExitInput: then the table named by `out` is as it
/// was. By hand kExitWaiting until the pictures of the next sheet are there.
int calibrateHeadCommand(const HeadCalibrateOptions& options);

/// Proves the cameras and the judge on artefacts with known deviation; writes gauge.json and gauge.html.
/// Returns 0 if no claim failed, 1 if one did, kExitInput. With a case named: repeats that alone, and returns
/// 0.
int gaugeCommand(const GaugeCommandOptions& options);

}  // namespace kerfbench::hil
