// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/selection.h"
#include "hil/dieline/read.h"
#include "hil/inspect/inspect.h"
#include "hil/scenario/analyser_choice.h"
#include "hil/scenario/camera_choice.h"
#include "hil/scenario/gpio_choice.h"
#include "hil/scenario/provoke_choice.h"
#include "twin/base/print_layout.h"
#include "twin/description/fidelity.h"
#include "twin/description/imperfections.h"
#include "twin/drive/speed_profile.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::scenario {

/// Release that runs, and dialog with it.
struct FirmwareChoice {
  enum class Source {
    kAvr,
    kMcs51,
    kCortexM,
    kNative,
    kChild,
    kGpio,      ///< Real pins of a controller; see `gpio`.
    kAnalyser,  ///< Real pins by a logic analyser; see `analyser`.
  };
  enum class Dialog {
    kKerfbench,  ///< The reference controller's frames (controller/protocol.h); the planner makes the
                 ///< program.
    kLineOk,     ///< Send a line, wait for "ok" (Grbl and its kin); `gcode` is what is sent.
    kNone,       ///< The job is in the controller, and is started at the machine or by itself.
  };
  Source source{Source::kAvr};
  Dialog dialog{Dialog::kKerfbench};
  std::filesystem::path image;     ///< Absolute. For kGpio: the one in the controller, if the file names it.
  std::filesystem::path child;     ///< Program that speaks the pin-stream protocol, for kChild.
  std::filesystem::path gcode;     ///< G-code, for kLineOk.
  std::vector<std::string> setup;  ///< Lines before it, for kLineOk.
  /// Bytes of the firmware's receive buffer that lines may fill before they are answered; 0: one line at a
  /// time. For kLineOk.
  std::size_t ahead_bytes{};
  std::filesystem::path
      eeprom;           ///< What the EEPROM holds, of an emulator or a child; empty: what the image says.
  bool eeprom_blank{};  ///< An erased EEPROM, whatever the image says.
  std::string mcu{"atmega2560"};
  std::uint64_t clock_hz{16'000'000};
  std::uint32_t baud{250'000};
  double quiet_s{};  ///< For kNone: the job is over when no axis of the head was pulsed for so long.
  std::optional<double> start_s;  ///< For kNone: time at which the start button is pressed; empty: never.
  GpioChoice gpio;                ///< Pins, for kGpio.
  AnalyserChoice analyser;        ///< Analyser, for kAnalyser.

  [[nodiscard]] bool onRealPins() const { return source == Source::kGpio || source == Source::kAnalyser; }
  /// The emulator that runs the image; null where none of the bench's does.
  [[nodiscard]] const struct Emulator* emulator() const;
  /// The program that speaks the pin stream for this release: the bench's emulator in the folder of its
  /// programs, a native release itself, or what the scenario names.
  [[nodiscard]] std::filesystem::path childIn(const std::filesystem::path& bin_dir) const;
};

/// Emulator that comes with the bench: a child process, and what a scenario need not say.
struct Emulator {
  FirmwareChoice::Source source{};
  std::string_view key;      ///< Value of `firmware.source`.
  std::string_view program;  ///< Name of the child in the folder of the programs.
  std::string_view runs;     ///< Kind of processor, for people.
  std::string_view mcu;
  std::uint64_t clock_hz{};
};
inline constexpr std::array kEmulators{
    Emulator{FirmwareChoice::Source::kAvr, "avr", "kerfbench-avr", "AVR", "atmega2560", 16'000'000},
    Emulator{FirmwareChoice::Source::kMcs51, "mcs51", "kerfbench-mcs51", "8051", "at89s52", 12'000'000},
    Emulator{FirmwareChoice::Source::kCortexM, "cortex_m", "kerfbench-cortex-m", "Cortex-M", "stm32f103c8",
             72'000'000}};

/// How much board grows or shrinks between cut and inspection, if both are done in one room within minutes:
/// what 0.1 % of relative humidity does to cartonboard across the grain (about 100 ppm for each per cent).
inline constexpr double kUsualSwelling_ppm = 10.0;

/// A scenario file, checked; all paths absolute.
struct Scenario {
  std::filesystem::path path;
  std::string text;  ///< The file as it is, for the report.
  /// The file, what it extends, and the files that these name.
  std::vector<std::filesystem::path> inputs;
  std::string name;
  std::string title;
  std::filesystem::path dieline;
  std::filesystem::path machine;
  dieline::DrawingOptions drawing;                ///< How the dieline is read.
  std::set<dieline::LintFinding::Kind> accepted;  ///< Faults of it that do not keep it from the laser.
  bool witness_required{};  ///< A second reader must read the drawing as ours does (hil/witness).
  std::vector<std::pair<Signal, std::string>> wires;  ///< Names of wires in recordings of other programs.
  planner::Selection selection;                       ///< Part of the dieline that is cut, and judged.
  twin::BoardDescription board;
  double swelling_sigma{};  ///< For the bench: relative growth of the board between cut and inspection.
  PrintLayout print;
  double print_sigma_mm{};   ///< For the bench: where a registration mark is printed, per axis.
  double belt_speed_mm_s{};  ///< Speed at t = 0, as the planner knows it.
  double belt_min_mm_s{}, belt_max_mm_s{};           ///< Speeds that the belt may have; 0: not told.
  std::vector<twin::SpeedPoint> belt_speed_changes;  ///< Speeds of the line that are to come.
  bool belt_by_controller{};             ///< The controller's feed pulses move the belt, not the line.
  std::optional<double> web_start_x_mm;  ///< x_W of unit 0's origin at t = 0; absent: from the lead time.
  double belt_lead_s{};  ///< Time until the first eye mark reaches the sensor (line), or the unit its start
                         ///< (controller).
  FirmwareChoice firmware;
  planner::JobParameters job;
  std::optional<double> jump_radius_mm;  ///< Radius of the job's jumps; the machine's if absent.
  planner::PlannerFaults planner_faults;
  std::filesystem::path job_gcode;  ///< One unit, edited by hand; empty: the planner writes it.
  ProvokeChoice provoke;
  CameraChoice cameras;
  inspect::Tolerances limits;
  std::string date;  ///< Day of the run, "2026-11-21"; empty: each calibration's own day.
  int calibration_max_age_days{inspect::kCalibrationMaxAge_days};
  double time_limit_s{};
  std::uint64_t seed{1};
  twin::Preset imperfections{twin::Preset::kIdeal};  ///< Distance of the machine from its description.
  twin::Fidelity fidelity{twin::Fidelity::kReference};

  /// True where the line moves the sheet.
  [[nodiscard]] bool sheetMoves() const { return belt_speed_mm_s != 0 || !belt_speed_changes.empty(); }
};

/// Preset or fidelity by its name in scenarios and on the command line: "ideal", "static", "dynamic";
/// "reference", "fast".
inline constexpr std::array kPresetNames{"ideal", "static", "dynamic"};
inline constexpr std::array kFidelityNames{"reference", "fast"};
inline const char* nameOf(twin::Preset preset) { return kPresetNames.at(static_cast<std::size_t>(preset)); }
inline const char* nameOf(twin::Fidelity fidelity) {
  return kFidelityNames.at(static_cast<std::size_t>(fidelity));
}
/// The one of this name. @throws std::out_of_range for any other.
twin::Preset presetFromName(const std::string& name);
twin::Fidelity fidelityFromName(const std::string& name);

/// Where release images are.
struct ImagePath {
  std::filesystem::path firmware_dir;  ///< Where images are looked for that do not lie beside the scenario.
  std::filesystem::path image{};       ///< The release, whatever the scenario names; empty: the scenario's.
};

/// A scenario, and every key that its reader asked for: docs/reference/scenario.md is held against them.
struct ScenarioFile {
  Scenario scenario;
  std::vector<base::YamlReader::Asked> keys;
};

/// A scenario as far as its text can be read.
struct ScenarioDraft {
  Scenario scenario;  ///< What is at fault has its default, or what is given nevertheless.
  std::vector<base::YamlReader::Asked> keys;
  std::vector<base::YamlReader::Fault> faults;  ///< Empty: the scenario is one.
};
/// Reads `text` as if it were the file `path`, which need not be there.
/// @throws ConfigError only for text that is no YAML mapping, and for a file that it extends.
ScenarioDraft draftScenario(const std::filesystem::path& path, const std::string& text,
                            const ImagePath& images);

/// @throws ConfigError with every fault, each with file and line.
ScenarioFile readScenarioFile(const std::filesystem::path& path, const ImagePath& images);
/// @throws ConfigError as above.
Scenario readScenario(const std::filesystem::path& path, const ImagePath& images);

}  // namespace kerfbench::scenario
