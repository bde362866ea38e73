// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "twin/scene/moving_scene.h"
#include "twin/scene/scene_parts.h"

namespace kerfbench::twin {
namespace {

constexpr double kBeltThickness_mm = 2.0;
constexpr double kMargin_mm = 8.0;  // Margin of board around what is printed and cut.
// Width of the eye mark across; the print's layout only gives the length.
constexpr double kEyeMark_mm = 10.0;
// Height of print: so little above the board that it only hides it.
constexpr double kPrintHeight_mm = 0.02;
constexpr int kHoleRows = 5;  // Rows of holes on either side of the belt's middle.

// Extent of one unit in its S.
Eigen::AlignedBox2d unitExtent(const PrintLayout& print, const SceneContent& content) {
  Eigen::AlignedBox2d unit = content.unit_S_mm;
  for (const RegistrationMark& mark : print.marks) {
    unit.extend(mark.p_SM_mm + Eigen::Vector2d::Constant(0.5 * mark.diameter_mm));
    unit.extend(mark.p_SM_mm - Eigen::Vector2d::Constant(0.5 * mark.diameter_mm));
  }
  if (unit.isEmpty()) return unit;
  unit.min() -= Eigen::Vector2d::Constant(kMargin_mm);
  unit.max() += Eigen::Vector2d::Constant(kMargin_mm);
  return unit;
}

void extend(Eigen::AlignedBox3d& box, double x, double y, double z) { box.extend(Eigen::Vector3d(x, y, z)); }

// Adds a roller with the hubs that show its turn, the belt around it, and its shaft.
void addRoller(SceneBuilder& build, double x_mm, double angle_rad, double radius_mm, const ConveyorLayout& at,
               const char* body) {
  const double z_mm = at.belt_z_mm - kBeltThickness_mm - radius_mm;
  const auto place = [&](double y) { return Eigen::Vector3d(x_mm, y, z_mm); };
  build.cylinder("roller", Material::kSteel, place(-at.half_width_mm - 4), place(at.half_width_mm + 4),
                 radius_mm);
  build.cylinder("belt", Material::kBelt, place(-at.half_width_mm), place(at.half_width_mm),
                 radius_mm + kBeltThickness_mm, radius_mm);
  const double hub_mm = 0.62 * radius_mm;
  build.cylinder("roller hub", Material::kSteel, place(-at.frame_y_mm - 5), place(-at.frame_y_mm), hub_mm);
  build.on(body);
  for (int i = 0; i < 4; ++i) {
    // The roller turns about +Wy: its top runs along +Wx.
    const double a = angle_rad + i * 0.5 * std::numbers::pi;
    const Eigen::Vector3d centre =
        place(-at.frame_y_mm - 5.05) + 0.64 * hub_mm * Eigen::Vector3d(std::sin(a), 0, std::cos(a));
    build.disc("roller bolt", i == 0 ? Material::kAxisX : Material::kDark,
               {centre, -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX(),
                Eigen::Vector2d::Constant(0.17 * hub_mm), 0.5});
  }
  build.on("");
  build.cylinder("roller shaft", Material::kSteel, place(-at.frame_y_mm - 14), place(at.frame_y_mm + 10),
                 0.2 * radius_mm);
}

double holePitch_mm(const ConveyorLayout& at) { return at.half_width_mm / kHolesPerHalfWidth; }

// A hole of the belt, its centre in the belt's face.
SceneBuilder::PlacedDisc holeAt(double x_mm, int row, const ConveyorLayout& at) {
  const double pitch_mm = holePitch_mm(at);
  return {{x_mm, pitch_mm * row, at.belt_z_mm + 0.01},
          Eigen::Vector3d::UnitZ(),
          Eigen::Vector3d::UnitX(),
          Eigen::Vector2d::Constant(0.09 * pitch_mm),
          0.005};
}

void addBeltHoles(SceneBuilder& build, double travel_mm, const ConveyorLayout& at) {
  const double pitch_mm = holePitch_mm(at);
  const double first_mm = at.min_x_mm + travel_mm - pitch_mm * std::floor(travel_mm / pitch_mm);
  const int columns = static_cast<int>((at.max_x_mm - first_mm) / pitch_mm) + 1;
  build.on(body_name::kBeltHoles);
  for (int column = 0; column < columns; ++column) {
    for (int row = -kHoleRows; row <= kHoleRows; ++row)
      build.disc("belt hole", Material::kBeltHole, holeAt(first_mm + pitch_mm * column, row, at));
  }
  build.on("");
}

void addSideFrames(SceneBuilder& build, double radius_mm, const ConveyorLayout& at) {
  const double low_mm = at.belt_z_mm - 2.0 * (radius_mm + kBeltThickness_mm) - 4.0;
  const double end_mm = 0.9 * radius_mm;
  Scene& scene = build.scene();
  for (const double side : {-1.0, 1.0}) {
    const double outer = side * at.frame_y_mm;
    const double inner = side * (at.half_width_mm + 5.0);
    build.box("side frame", Material::kAluminium, {at.min_x_mm - end_mm, std::min(outer, inner), low_mm},
              {at.max_x_mm + end_mm, std::max(outer, inner), at.frame_top_mm}, 1.5);
    for (const double x : {at.min_x_mm + 2 * radius_mm, at.max_x_mm - 2 * radius_mm}) {
      const double y = side * 0.5 * (at.frame_y_mm + at.half_width_mm + 5.0);
      const double half = 0.35 * radius_mm + 6.0;
      build.box("foot", Material::kPaint, {x - half, y - half, scene.floor_z_mm},
                {x + half, y + half, low_mm}, 2.0);
    }
  }
  extend(scene.overall, at.min_x_mm - 1.3 * radius_mm, -at.frame_y_mm - 14, scene.floor_z_mm);
  extend(scene.overall, at.max_x_mm + 1.3 * radius_mm, at.frame_y_mm + 10, at.frame_top_mm);
}

void addMarkSensor(SceneBuilder& build, double x_mm, const ConveyorLayout& at) {
  const double y = at.eye_mark_y_mm;
  const double s = std::clamp(at.half_width_mm / 12.0, 8.0, 22.0);
  const double z = 1.6 * s;
  build.box("print mark sensor", Material::kDark, {x_mm - 0.6 * s, y - 0.6 * s, z},
            {x_mm + 0.6 * s, y + 0.6 * s, z + 2.2 * s}, 1.0);
  build.cylinder("print mark sensor", Material::kSteel, {x_mm, y, z - 0.4 * s}, {x_mm, y, z}, 0.35 * s);
  build.box("print mark sensor", Material::kAluminium, {x_mm - 0.3 * s, -at.frame_y_mm, z + 1.2 * s},
            {x_mm + 0.3 * s, y, z + 1.6 * s}, 0.5);
  build.box("print mark sensor", Material::kAluminium,
            {x_mm - 0.3 * s, -at.frame_y_mm, at.frame_top_mm - 5.0},
            {x_mm + 0.3 * s, -at.frame_y_mm + 0.5 * s, z + 1.6 * s}, 0.5);
}

// Extent of all units, in S of unit 0; empty: there is no board.
Eigen::AlignedBox2d wholeBoard(const PrintLayout& print, const SceneContent& content) {
  Eigen::AlignedBox2d board = unitExtent(print, content);
  if (!board.isEmpty()) board.min().x() -= print.pitch_mm * (print.units - 1);
  return board;
}

// Extent of the board along x and y in W, cut off at the ends of the belt; empty: none is on the belt.
Eigen::AlignedBox2d boardOnBelt(const WebDescription& web, const SceneContent& content,
                                const ConveyorLayout& at, const Eigen::Vector2d& p_WS_mm) {
  Eigen::AlignedBox2d board = wholeBoard(web.print, content);
  if (board.isEmpty()) return board;
  board.translate(p_WS_mm);
  const Eigen::AlignedBox2d belt(Eigen::Vector2d(at.min_x_mm, -1e9), Eigen::Vector2d(at.max_x_mm, 1e9));
  return board.intersection(belt);
}

SceneBuilder::PlacedDisc markAt(const Eigen::Vector2d& p_mm, double diameter_mm) {
  return {{p_mm.x(), p_mm.y(), kPrintHeight_mm},
          Eigen::Vector3d::UnitZ(),
          Eigen::Vector3d::UnitX(),
          Eigen::Vector2d::Constant(0.5 * diameter_mm),
          0.5 * kPrintHeight_mm};
}

// Adds an eye mark by the middle of its leading edge.
void addEyeMark(SceneBuilder& build, const PrintLayout& print, double x_mm, double y_mm) {
  build.box("eye mark", Material::kPrint,
            {x_mm - print.eye_mark_length_mm, y_mm - 0.5 * kEyeMark_mm, 0.5 * kPrintHeight_mm},
            {x_mm, y_mm + 0.5 * kEyeMark_mm, kPrintHeight_mm});
}

void addPrint(SceneBuilder& build, const PrintLayout& print, const Eigen::AlignedBox2d& board,
              const ConveyorLayout& at, const Eigen::Vector2d& p_WS_mm) {
  for (int unit = 0; unit < print.units; ++unit) {
    const Eigen::Vector2d p_WU_mm = p_WS_mm - Eigen::Vector2d(print.pitch_mm * unit, 0.0);
    for (const RegistrationMark& mark : print.marks) {
      const Eigen::Vector2d p = p_WU_mm + mark.p_SM_mm;
      if (!board.contains(p)) continue;
      build.disc("registration mark", Material::kPrint, markAt(p, mark.diameter_mm));
    }
    const Eigen::Vector2d edge = p_WU_mm + Eigen::Vector2d(print.eye_mark_x_mm, 0.0);
    const double y = p_WS_mm.y() + at.eye_mark_y_mm;
    if (print.marks.empty() || !board.contains(Eigen::Vector2d(edge.x(), y))) continue;
    addEyeMark(build, print, edge.x(), y);
  }
}

// Adds the burnt paths, broken where they leave the belt.
void addBurnt(Scene& scene, const SceneContent& content, const Eigen::AlignedBox2d& board,
              const Eigen::Vector2d& p_WS_mm) {
  for (const auto& path : content.burnt_S_mm) {
    std::vector<Eigen::Vector3d> line;
    for (const Eigen::Vector2d& p_S : path) {
      const Eigen::Vector2d p = p_WS_mm + p_S;
      if (board.contains(p)) {
        line.emplace_back(p.x(), p.y(), 0.0);
      } else if (line.size() > 1) {
        scene.burnt.push_back(std::move(line));
        line.clear();
      } else {
        line.clear();
      }
    }
    if (line.size() > 1) scene.burnt.push_back(std::move(line));
  }
}

}  // namespace

ConveyorLayout conveyorLayout(const MachineDescription& machine, const WebDescription& web,
                              const SceneContent& content) {
  const bool gantry = machine.kind == MachineDescription::Kind::kGantry;
  const ControllerDescription& controller = machine.controller;
  const Eigen::AlignedBox2d unit = unitExtent(web.print, content);
  double reach_mm = std::max(std::abs(controller.field_min_mm[1]), std::abs(controller.field_max_mm[1]));
  if (!unit.isEmpty()) reach_mm = std::max({reach_mm, -unit.min().y(), unit.max().y()});
  ConveyorLayout at;
  at.half_width_mm = 1.08 * reach_mm + 6.0;
  const double sensor_x_mm = machine.belt.print_mark_sensor.x_mm;
  const double low_mm = gantry ? machine.travel_min_mm[0] : controller.field_min_mm[0];
  const double high_mm = gantry ? machine.travel_max_mm[0] : controller.field_max_mm[0];
  const double run_out_mm = 0.12 * (high_mm - low_mm) + 3.0 * machine.belt.roller_radius_mm;
  at.min_x_mm = std::min(sensor_x_mm, low_mm) - run_out_mm;
  at.max_x_mm = high_mm + run_out_mm;
  at.belt_z_mm = -web.board.thickness_mm;
  at.frame_y_mm = at.half_width_mm + 5.0 + std::max(10.0, 0.06 * at.half_width_mm);
  at.frame_top_mm = at.belt_z_mm - 2.5;
  at.eye_mark_y_mm = std::max(-0.78 * at.half_width_mm, unit.isEmpty() ? -1e9 : unit.min().y() + kEyeMark_mm);
  return at;
}

void addConveyor(SceneBuilder& build, const MachineDescription& machine, const MachinePose& pose,
                 const ConveyorLayout& at) {
  const double radius_mm = machine.belt.roller_radius_mm;
  const double low_mm = at.belt_z_mm - 2.0 * (radius_mm + kBeltThickness_mm);
  build.scene().floor_z_mm = low_mm - 0.8 * radius_mm - 12.0;
  build.box("belt", Material::kBelt, {at.min_x_mm, -at.half_width_mm, at.belt_z_mm - kBeltThickness_mm},
            {at.max_x_mm, at.half_width_mm, at.belt_z_mm});
  build.box("belt", Material::kBelt, {at.min_x_mm, -at.half_width_mm, low_mm},
            {at.max_x_mm, at.half_width_mm, low_mm + kBeltThickness_mm});
  addBeltHoles(build, pose.belt_travel_mm, at);
  const double angle_rad = pose.roller_mm / radius_mm;
  addRoller(build, at.min_x_mm, angle_rad, radius_mm, at, body_name::kInfeed);
  addRoller(build, at.max_x_mm, angle_rad, radius_mm, at, body_name::kOutfeed);
  addSideFrames(build, radius_mm, at);
  addMarkSensor(build, machine.belt.print_mark_sensor.x_mm, at);
  const double z_mm = at.belt_z_mm - kBeltThickness_mm - radius_mm;
  build.cylinder("encoder", Material::kDark, {at.max_x_mm, -at.frame_y_mm - 14.0 - 0.7 * radius_mm, z_mm},
                 {at.max_x_mm, -at.frame_y_mm - 9.0, z_mm}, 0.34 * radius_mm);
  const double half = 0.8 * radius_mm;
  build.box("line motor", Material::kDark, {at.max_x_mm - half, at.frame_y_mm + 4.0, z_mm - half},
            {at.max_x_mm + half, at.frame_y_mm + 4.0 + 3.2 * radius_mm, z_mm + half}, 3.0);
}

void addBoard(SceneBuilder& build, const WebDescription& web, const SceneContent& content,
              const ConveyorLayout& at, const Eigen::Vector2d& p_WS_mm) {
  Scene& scene = build.scene();
  const Eigen::AlignedBox2d board = boardOnBelt(web, content, at, p_WS_mm);
  if (board.isEmpty()) return;
  build.box("board", Material::kBoard, {board.min().x(), board.min().y(), at.belt_z_mm},
            {board.max().x(), board.max().y(), 0.0});
  addPrint(build, web.print, board, at, p_WS_mm);
  addBurnt(scene, content, board, p_WS_mm);
  extend(scene.sheet, board.min().x(), board.min().y(), 0.0);
  extend(scene.sheet, board.max().x(), board.max().y(), 0.0);
}

void addWholeWeb(MovingScene& moving, const WebDescription& web, const SceneContent& content,
                 const ConveyorLayout& at) {
  const BeltEnds ends{at.min_x_mm, at.max_x_mm};
  const double pitch_mm = holePitch_mm(at);
  const PrintLayout& print = web.print;
  Scene scene;
  SceneBuilder build(scene);
  const auto add = [&](const Eigen::Vector3d& step_mm, int count, ShownOnBelt shown) {
    moving.parts.push_back(
        {scene.parts.back(), moving.bodyNamed(scene.parts.back().body), count, step_mm, shown});
  };
  build.on(body_name::kBeltHoles);
  const int columns = static_cast<int>((at.max_x_mm - at.min_x_mm) / pitch_mm) + 1;
  for (int row = -kHoleRows; row <= kHoleRows; ++row) {
    const SceneBuilder::PlacedDisc hole = holeAt(at.min_x_mm, row, at);
    build.disc("belt hole", Material::kBeltHole, hole);
    add({pitch_mm, 0.0, 0.0}, columns, {ShownOnBelt::How::kWholeWithin, ends, hole.centre_mm});
  }
  Eigen::AlignedBox2d board = wholeBoard(print, content);
  if (board.isEmpty()) return;
  build.on(body_name::kWeb);
  const Eigen::Vector2d p_WS_mm(web.start_x_mm, 0.0);
  board.translate(p_WS_mm);
  build.box("board", Material::kBoard, {board.min().x(), board.min().y(), at.belt_z_mm},
            {board.max().x(), board.max().y(), 0.0});
  add(Eigen::Vector3d::Zero(), 1, {ShownOnBelt::How::kCut, ends, Eigen::Vector3d::Zero()});
  const Eigen::Vector3d step_mm(-print.pitch_mm, 0.0, 0.0);
  for (const RegistrationMark& mark : print.marks) {
    const SceneBuilder::PlacedDisc disc = markAt(p_WS_mm + mark.p_SM_mm, mark.diameter_mm);
    build.disc("registration mark", Material::kPrint, disc);
    add(step_mm, print.units, {ShownOnBelt::How::kWholeWithin, ends, disc.centre_mm});
  }
  // The board may end before the eye mark of the first unit, or of the last.
  const auto isOnBoard = [&](int unit) {
    return board.contains(
        Eigen::Vector2d(p_WS_mm.x() + print.eye_mark_x_mm - print.pitch_mm * unit, at.eye_mark_y_mm));
  };
  int first = 0;
  int end = print.marks.empty() ? 0 : print.units;
  while (first < end && !isOnBoard(first)) ++first;
  while (end > first && !isOnBoard(end - 1)) --end;
  if (first == end) return;
  const double x_mm = p_WS_mm.x() + print.eye_mark_x_mm - print.pitch_mm * first;
  addEyeMark(build, print, x_mm, at.eye_mark_y_mm);
  add(step_mm, end - first, {ShownOnBelt::How::kWholeWithin, ends, {x_mm, at.eye_mark_y_mm, 0.0}});
}

}  // namespace kerfbench::twin
