// SPDX-License-Identifier: Apache-2.0
#pragma once

// The sections of a machine file, one reader each. Private to this room. All of them put their issues into
// the file's list (YamlReader) and never throw.

#include <array>
#include <optional>
#include <string_view>

#include "hil/base/yaml_reader.h"
#include "hil/machine_file/drive_catalogue.h"
#include "twin/description/description.h"
#include "twin/description/imperfections.h"

namespace kerfbench::machine_file {

inline constexpr double kPercent = 0.01;

SignalMap readPins(base::YamlReader pins, twin::MachineDescription::Kind kind);
std::optional<twin::FrameDescription> readFrame(base::YamlReader& file);

/// Load of an axis: a mirror (rad, kg m²), a slide (mm, kg), or the belt's roller (rad; steps in mm of the
/// belt).
enum class Load { kMirror, kSlide, kBelt };
/// `roller_…`: of the belt, for Load::kBelt alone.
twin::AxisDescription readAxis(base::YamlReader axis, Load load, const DriveCatalogue& catalogue,
                               double roller_inertia_kg_m2 = 0.0, double roller_radius_mm = 0.0);

twin::ScanHeadDescription readHead(base::YamlReader optics);
twin::BeamDescription readBeam(base::YamlReader& beam);
twin::SurfaceDescription readSurface(base::YamlReader surface);
twin::BeltDescription readBelt(base::YamlReader belt, const DriveCatalogue& catalogue);
twin::FrictionDescription readFriction(base::YamlReader friction, Load load);
twin::LaserDescription readLaser(base::YamlReader laser);
twin::PowerMonitorDescription readPowerMonitor(base::YamlReader monitor);
/// `timed`: the spot camera, which takes frame after frame.
twin::CameraDescription readCamera(base::YamlReader& camera, bool timed);
/// Imperfections that make pictures as hard as real ones; all of them off by default.
void readCameraFlaws(base::YamlReader& camera, bool timed, twin::CameraDescription& result);
twin::ControllerDescription readController(base::YamlReader told, twin::MachineDescription::Kind kind);
twin::ImperfectionSpread readSpread(base::YamlReader section);

/// Reads two limits, the lower first.
std::array<std::array<double, 2>, 2> readBox(base::YamlReader& section, std::string_view x_key,
                                             std::string_view y_key);

}  // namespace kerfbench::machine_file
