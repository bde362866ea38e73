// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "twin/description/description.h"
#include "twin/description/imperfections.h"

namespace kerfbench::machine_file {

/// Camera in a machine file, as the bench knows it: by its calibration alone.
struct CameraFile {
  std::string id;                     ///< Serial number or name.
  std::filesystem::path calibration;  ///< Absolute; it need not be there.
  bool named_here{};  ///< True where this machine's own file or its default names it; false for a file that
                      ///< it extends.
  /// Kerf camera: standard uncertainty of a tile's place as the inspection table reads it, per axis.
  double table_sigma_mm{};
  double table_straightness_mm{};  ///< Kerf camera: by how much the table's axes bow, RMS.
  double table_scale_sigma{};      ///< Kerf camera: relative standard uncertainty of the table's scale.
  double target_scale_sigma{};     ///< Kerf camera: the same of the target that it was calibrated with.
  double open_gray_sigma{};        ///< Kerf camera: relative standard uncertainty of its open_gray.
};

/// A machine file, read and checked. docs/reference/machine.md explains every key.
struct MachineFile {
  twin::MachineDescription machine;
  twin::ImperfectionSpread spread;  ///< Section `imperfections`.
  CameraFile spot_camera, kerf_camera;
  double beam_radius_sigma{};  ///< For the bench: relative standard uncertainty of the beam's radius.
  /// The file, what it extends, and the files that these name: drives, correction table, calibrations.
  std::vector<std::filesystem::path> inputs;
  /// Every key that was asked for, the given and the others.
  std::vector<base::YamlReader::Asked> keys;
  /// "file:line" of what the twin calls by the name of a field, e.g. "galvo_x.load_inertia"; of the section,
  /// or the file, where there is no such key.
  [[nodiscard]] std::string placeOf(const std::string& field) const;
  /// Place ("file:line") of every key asked for and of every section.
  std::map<std::string, std::string> places;
  std::set<std::string> given;  ///< Keys of `places` that the file gives.
};

/// Drives are named in the machine and looked up in the catalogue that its `drivers` names.
/// @throws ConfigError with every fault, each with file and line.
MachineFile readMachineFile(const std::filesystem::path& path);

/// The description alone.
twin::MachineDescription readMachine(const std::filesystem::path& path);

}  // namespace kerfbench::machine_file
