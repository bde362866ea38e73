// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kerfbench::window {

/// What the commands serve and view have in common.
struct ServeOptions {
  std::filesystem::path folder{"."};
  std::string address{"127.0.0.1"};
  int port{};                          ///< 0: one that is free.
  bool open{};                         ///< Starts the browser.
  std::vector<std::string> benches{};  ///< Addresses of others, as these have printed them.
  std::filesystem::path bin_dir;
};

struct ViewOptions {
  ServeOptions serve;  ///< The folder is not looked at.
  std::filesystem::path trace;
  std::optional<double> at_s;  ///< Simulated; >= 0.
};

/// Serves the window of a folder until SIGINT, SIGTERM or SIGHUP, and tells its address on standard output.
/// Returns 0 or base::kExitInput.
int serveCommand(const ServeOptions& options);

/// The same with a trace opened: of the current folder if the trace lies in it, else of the trace's own.
int viewCommand(const ViewOptions& options);

}  // namespace kerfbench::window
