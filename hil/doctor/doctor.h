// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/camera/v4l2/device_list.h"
#include "hil/scenario/case.h"
#include "hil/source/analyser/analyser.h"
#include "hil/source/gpio/chips.h"

namespace kerfbench::doctor {

/// Computer as far as real pins care. Each kind of hardware adds its list here.
struct ComputerState {
  std::string kernel;  ///< "Linux 6.1.0-18-amd64".
  source::GpioChipList gpio;
  std::vector<std::string> gpio_troubles;  ///< Chips whose edges cannot be read without losing some.
  std::vector<camera::CameraListing> cameras;
  source::AnalyserList analysers;
  std::string analyser_trouble;              ///< Reason why they could not be listed; empty: they could.
  std::string clock_source;                  ///< Clock of the kernel: "tsc"; empty: it does not say.
  std::uint64_t clock_resolution_ns{};       ///< Resolution of CLOCK_MONOTONIC.
  std::vector<std::string> real_time_notes;  ///< Rights that lack and how to grant them; empty: none.
};
/// Findings about this computer: ComputerState's.
std::string kernelName();
std::string clockSource();
/// Looks; changes nothing but the priority of the thread, for a moment.
ComputerState lookAtComputer(const std::shared_ptr<source::GpioSystem>& system, camera::VideoCalls& video);

/// Fills in the logic analysers. Opens each for a moment.
void lookAtAnalysers(source::AnalyserSystem& system, ComputerState& state);
/// "fx2lafw: Saleae Logic, at 1.14".
std::string analyserName(const source::AnalyserDevice& device);

/// One thing that was looked at.
struct DoctorFinding {
  enum class Grade {
    kGood,
    kNote,     ///< Circumstance that prevents nothing.
    kTrouble,  ///< Something is there and does not work.
    kMissing,  ///< The scenario needs it.
  };
  Grade grade{};
  std::string text;  ///< Finding in words, and what to do.
};

/// Findings about the computer alone: kGood, kNote or kTrouble.
std::vector<DoctorFinding> findingsOf(const ComputerState& state);
/// Findings about what a case needs: kGood or kMissing. `bin_dir`: where kerfbench's children are.
std::vector<DoctorFinding> needsOf(const scenario::Case& test_case, const ComputerState& state,
                                   const std::filesystem::path& bin_dir);

/// The findings alone, a line each, and as JSON with the `findings` of doctorJson().
std::string findingsText(const std::vector<DoctorFinding>& findings);
std::string findingsJson(const std::vector<DoctorFinding>& findings);
/// The part of findingsOf() and needsOf() that is about logic analysers.
void addAnalyserFindings(const ComputerState& state, std::vector<DoctorFinding>& findings);
void addAnalyserNeeds(const scenario::AnalyserChoice& choice, const ComputerState& state,
                      std::vector<DoctorFinding>& findings);

/// Report for people, and as JSON. `scenario`: name of the case whose needs are among the findings, or empty.
std::string doctorText(const ComputerState& state, const std::vector<DoctorFinding>& findings);
std::string doctorJson(const ComputerState& state, const std::vector<DoctorFinding>& findings,
                       const std::string& scenario);

}  // namespace kerfbench::doctor
