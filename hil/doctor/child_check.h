// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/doctor/doctor.h"

namespace kerfbench::doctor {

/// A program that is to speak the pin stream, and what it is tried with.
struct ChildOptions {
  std::filesystem::path child;  ///< Empty: none is tried.
  std::filesystem::path image;
  double seconds{0.2};            ///< Virtual, of each run.
  std::string mcu{"atmega2560"};  ///< Asked for in OPEN, as the next two.
  std::uint64_t clock_hz{16'000'000};
  std::uint32_t baud{250'000};
};

/// Whether a child keeps what docs/reference/pin-stream.md asks of it, as far as an image shows it: it starts
/// and says its tick; it runs as far as it is asked, with events in order; a second run makes the same, and
/// one in other quanta too; an image that is not there is refused in words. kGood or kTrouble.
std::vector<DoctorFinding> checkChild(const ChildOptions& options);

}  // namespace kerfbench::doctor
