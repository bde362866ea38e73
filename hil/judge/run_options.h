// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace kerfbench::judge {

/// What all commands that judge have in common.
struct RunOptions {
  std::filesystem::path results_dir{"results"};
  std::filesystem::path events;        ///< File for base::EventLog; empty: nobody watches.
  std::filesystem::path output;        ///< The folder for the results itself; empty: one below results_dir.
  std::optional<std::uint64_t> seed;   ///< Instead of the scenario's.
  std::optional<double> time_limit_s;  ///< Virtual; instead of the scenario's.
  std::optional<std::string> imperfections;  ///< Name of a preset; instead of the scenario's.
  std::optional<std::string> twin;           ///< Name of a fidelity; instead of the scenario's.
  int jobs{1};
  bool quiet{};
  bool timing{};
  bool pictures{true};            ///< Whether the report has pictures of the machine.
  bool verbose{};                 ///< Progress is told without a terminal as well.
  bool keep_evidence{};           ///< Whether the evidence of the diagnosis goes into the results folder.
  bool trace{};                   ///< Whether the run is written as a trace, for people.
  int trace_frames{50};           ///< Every Nth frame of the spot camera goes into it; 0: none.
  std::string serial_number;      ///< What is tested; nothing is judged by it.
  std::filesystem::path bin_dir;  ///< Where kerfbench and its children are.
  std::string command_line;       ///< As typed, for the report.
};

}  // namespace kerfbench::judge
