// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace kerfbench::scene {

/// Failure to make a picture: the ray tracer is missing, refuses the scene or does not come to an end.
class PictureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct PovrayOptions {
  /// The program: a name that is looked up in PATH, or a path.
  std::filesystem::path program{"povray"};
  int width_px{1280};        ///< 1 … 8192
  int height_px{800};        ///< 1 … 8192
  double patience_s{120.0};  ///< Wall clock, after which it is stopped.
};

/// Renders a scene of the POV-Ray language, without display and on one thread, in a folder of its own below
/// the system's temporary folder; no configuration of the user or the host takes part. Returns the picture
/// file (PNG) as POV-Ray wrote it.
/// @throws PictureError that says what to do about it, std::system_error when the system fails.
std::vector<std::uint8_t> runPovray(const std::string& scene, const PovrayOptions& options);

/// Whether the program is there to be run.
bool povrayFound(const std::filesystem::path& program = "povray");

}  // namespace kerfbench::scene
