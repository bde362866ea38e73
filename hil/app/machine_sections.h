// SPDX-License-Identifier: Apache-2.0
#pragma once

// The sections of a machine file, one reader each. Private to hil/app. All of them put their faults into the
// file's list (YamlReader) and never throw.

#include <array>
#include <optional>
#include <string_view>

#include "hil/app/drive_catalogue.h"
#include "hil/base/yaml_reader.h"
#include "twin/cutter/description.h"
#include "twin/cutter/imperfections.h"

namespace kerfbench::hil {

inline constexpr double kMicro = 1e-6;
inline constexpr double kMilli = 1e-3;

SignalMap readPins(YamlReader pins, twin::MachineDescription::Kind kind);
std::optional<twin::FrameDescription> readFrame(YamlReader& file);

/// What an axis moves: a mirror (rad, kg m²), a slide (mm, kg), or the belt's roller (rad; steps in mm of the
/// belt).
enum class Load { kMirror, kSlide, kBelt };
/// `roller_…`: of the belt, for Load::kBelt alone.
twin::AxisDescription readAxis(YamlReader axis, Load load, const DriveCatalogue& catalogue,
                               double roller_inertia_kg_m2 = 0.0, double roller_radius_mm = 0.0);

twin::ScanHeadDescription readHead(YamlReader optics);
twin::BeamDescription readBeam(YamlReader beam);
twin::SurfaceDescription readSurface(YamlReader surface);
twin::BeltDescription readBelt(YamlReader belt, const DriveCatalogue& catalogue);
twin::FrictionDescription readFriction(YamlReader friction, Load load);
twin::LaserDescription readLaser(YamlReader laser);
twin::PowerMonitorDescription readPowerMonitor(YamlReader monitor);
/// `timed`: the spot camera, which takes frame after frame.
twin::CameraDescription readCamera(YamlReader& camera, bool timed);
/// What makes its pictures as hard as real ones; all of it off by default.
void readCameraFlaws(YamlReader& camera, bool timed, twin::CameraDescription& result);
twin::ControllerDescription readController(YamlReader told, twin::MachineDescription::Kind kind);
twin::ImperfectionSpread readSpread(YamlReader section);

/// Reads two limits, the lower first.
std::array<std::array<double, 2>, 2> readBox(YamlReader& section, std::string_view x_key,
                                             std::string_view y_key);

}  // namespace kerfbench::hil
