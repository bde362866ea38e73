// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/pov_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "hil/scene/pov_materials.h"

namespace kerfbench::scene {
namespace {

using Eigen::Vector3d;
using twin::Material;
using twin::Scene;
using twin::ScenePart;

std::string vec(const Vector3d& v) { return fmt::format("<{:.6g},{:.6g},{:.6g}>", v.x(), v.y(), v.z()); }

// POV-Ray multiplies row vectors: the matrix is written column by column.
std::string poseText(const Eigen::Isometry3d& X) {
  const auto column = [&](int i) {
    const Vector3d c = X.linear().col(i);
    return fmt::format("{:.9g},{:.9g},{:.9g}", c.x(), c.y(), c.z());
  };
  const Vector3d t = X.translation();
  return fmt::format("matrix <{},{},{},{:.6g},{:.6g},{:.6g}>", column(0), column(1), column(2), t.x(), t.y(),
                     t.z());
}

// The body of a shape in its own frame.
struct ShapeText {
  std::string operator()(const twin::Box& box) const {
    const Vector3d half = 0.5 * box.size_mm;
    const double edge = std::min(box.edge_radius_mm, 0.49 * box.size_mm.minCoeff());
    if (edge <= 0) return fmt::format("box {{ {}, {}", vec(-half), vec(half));
    return fmt::format("object {{ RoundBox({}, {:.6g})", vec(half), edge);
  }
  std::string operator()(const twin::Cylinder& c) const {
    const Vector3d end(0, 0, 0.5 * c.length_mm);
    if (!(c.bore_mm > 0)) return fmt::format("cylinder {{ {}, {}, {:.6g}", vec(-end), vec(end), c.radius_mm);
    return fmt::format("difference {{ cylinder {{ {}, {}, {:.6g} }} cylinder {{ {}, {}, {:.6g} }}", vec(-end),
                       vec(end), c.radius_mm, vec(-1.01 * end), vec(1.01 * end), c.bore_mm);
  }
  std::string operator()(const twin::Disc& disc) const {
    return fmt::format("cylinder {{ <0,0,{:.6g}>, <0,0,0>, 1 scale <{:.6g},{:.6g},1>", -disc.thickness_mm,
                       disc.radius_mm.x(), disc.radius_mm.y());
  }
  std::string operator()(const twin::Cone& cone) const {
    return fmt::format("cone {{ <0,0,0>, {:.6g}, <0,0,{:.6g}>, 0", cone.radius_mm, cone.length_mm);
  }
};

void addParts(std::string& text, const Scene& scene) {
  for (const ScenePart& part : scene.parts) {
    const bool lampless = part.material == Material::kGlass || part.material == Material::kTube;
    fmt::format_to(std::back_inserter(text), "{}{} {} {} }}{} // {}\n", lampless ? "light_group { " : "",
                   std::visit(ShapeText{}, part.shape), materialName(part.material), poseText(part.X_WP),
                   lampless ? " global_lights off }" : "", part.name);
    const auto* const tube = std::get_if<twin::Cylinder>(&part.shape);
    if (part.material != Material::kTube || tube == nullptr) continue;
    // The discharge inside the glass.
    const Vector3d end(0, 0, 0.48 * tube->length_mm);
    fmt::format_to(std::back_inserter(text), "cylinder {{ {}, {}, {:.6g} {} {} }}\n", vec(-end), vec(end),
                   0.45 * tube->radius_mm, scene.beam_on ? "texture { T_Discharge }" : "texture { T_Bore }",
                   poseText(part.X_WP));
  }
}

void addCamera(std::string& text, const Viewpoint& view) {
  const double aspect = static_cast<double>(view.height_px()) / view.width_px();
  fmt::format_to(std::back_inserter(text),
                 "camera {{ perspective location {} direction {} right {} up {} }}\n", vec(view.place_mm()),
                 vec(view.forward()), vec(2.0 * view.half_width_tan() * view.right()),
                 vec(2.0 * aspect * view.half_width_tan() * view.up()));
}

// A large soft lamp over the reader's left shoulder, fill from the right and from above; lamps that only
// mirrors see give the metal something to reflect.
void addLights(std::string& text, const Scene& scene, const Viewpoint& view) {
  const Vector3d centre = scene.overall.center();
  const double span = scene.overall.diagonal().norm();
  const auto from = [&](double right, double near, double up) {
    Vector3d toward = -view.forward();
    toward.z() = 0;
    if (toward.norm() < 1e-3) toward = -view.up();
    return Vector3d(centre +
                    span * (right * view.right() + near * toward.normalized() + up * Vector3d::UnitZ()));
  };
  const Vector3d key = from(-1.3, 1.1, 2.2);
  const Vector3d along = 0.13 * span * view.right();
  const Vector3d across = 0.13 * span * Vector3d(centre - key).cross(view.right()).normalized();
  const auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      "light_source {{ {} rgb <1.0,0.97,0.92>*1.15 area_light {}, {}, 5, 5 adaptive 1 circular orient }}\n",
      vec(key), vec(along), vec(across));
  fmt::format_to(out, "light_source {{ {} rgb <0.75,0.85,1.0>*0.30 shadowless }}\n",
                 vec(from(1.8, 0.7, 0.8)));
  fmt::format_to(out, "light_source {{ {} rgb 0.14 shadowless }}\n", vec(from(-0.2, -0.9, 2.0)));
  const Vector3d soft = from(0.4, 0.7, 1.9);
  fmt::format_to(
      out,
      "box {{ <-1,-1,0>, <1,1,0.01> pigment {{ rgb 1 }} finish {{ emission 1.5 ambient 0 diffuse 0 }} "
      "no_image no_shadow scale {:.6g} translate {} }}\n",
      0.55 * span, vec(soft));
  // The floor fades into the background: it has no edge.
  fmt::format_to(out, "fog {{ fog_type 1 distance {:.6g} rgb <0.40,0.42,0.45> }}\n", 50.0 * span);
  fmt::format_to(
      out,
      "plane {{ z, {:.6g} pigment {{ rgb <0.47,0.49,0.52> }} finish {{ ambient 0.03 diffuse 0.75 }} }}\n",
      scene.floor_z_mm);
}

void addGlow(std::string& text, const Scene& scene, const Viewpoint& view) {
  const auto out = std::back_inserter(text);
  const auto shell = [&](double of_radius, double pixels, const char* material) {
    for (std::size_t i = 0; i + 1 < scene.beam.size(); ++i) {
      const auto& a = scene.beam[i];
      const auto& b = scene.beam[i + 1];
      const double ra = std::max(of_radius * a.radius_mm, pixels * view.pixel_mm(a.p_W_mm));
      const double rb = std::max(of_radius * b.radius_mm, pixels * view.pixel_mm(b.p_W_mm));
      fmt::format_to(out,
                     "light_group {{ cone {{ {}, {:.6g}, {}, {:.6g} open texture {{ {} }} no_shadow }} "
                     "global_lights off }}\n",
                     vec(a.p_W_mm), ra, vec(b.p_W_mm), rb, material);
    }
  };
  if (!scene.beam_on) {
    shell(0.3, 0.6, "T_BeamOff");
    return;
  }
  shell(0.8, 1.4, "T_BeamCore");
  shell(2.2, 5.0, "T_BeamGlow");
}

void addSpot(std::string& text, const Scene& scene, const Viewpoint& view) {
  if (!scene.beam_on || scene.beam.empty()) return;
  const Vector3d spot = scene.beam.back().p_W_mm;
  const double px = view.pixel_mm(spot);
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "light_group {{ sphere {{ {}, {:.6g} texture {{ T_Spot }} no_shadow }}\n", vec(spot),
                 2.4 * px);
  fmt::format_to(out, "sphere {{ {}, {:.6g} texture {{ T_BeamGlow }} no_shadow }}\n", vec(spot), 9.0 * px);
  fmt::format_to(out, "global_lights off }}\n");
  fmt::format_to(
      out, "light_source {{ {} rgb <1.0,0.35,0.08>*1.6 fade_distance {:.6g} fade_power 2 shadowless }}\n",
      vec(spot + Vector3d(0, 0, 9.0 * px)), 16.0 * px);
}

// The point of line[first … last] that lies farthest from the chord between these two, and how far.
std::pair<std::size_t, double> farthestFromChord(const std::vector<Vector3d>& line, std::size_t first,
                                                 std::size_t last) {
  const Vector3d chord = line[last] - line[first];
  std::pair<std::size_t, double> worst{first, 0.0};
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vector3d q = line[i] - line[first];
    const double along =
        chord.squaredNorm() > 0 ? std::clamp(q.dot(chord) / chord.squaredNorm(), 0.0, 1.0) : 0.0;
    const double off = (q - along * chord).norm();
    if (off > worst.second) worst = {i, off};
  }
  return worst;
}

// Drops points that lie within `tolerance` of the chord (Douglas and Peucker 1973). A stack instead of calls:
// a spiral splits as often as it has points.
std::vector<Vector3d> thinned(const std::vector<Vector3d>& line, double tolerance) {
  std::vector<Vector3d> kept{line.front()};
  std::vector<std::size_t> ends{line.size() - 1};
  std::size_t first = 0;
  while (!ends.empty()) {
    const auto [at, off] = farthestFromChord(line, first, ends.back());
    if (off > tolerance) {
      ends.push_back(at);
    } else {
      first = ends.back();
      ends.pop_back();
      kept.push_back(line[first]);
    }
  }
  return kept;
}

// How large a pixel is where the line comes nearest to the eye; nothing where all of it lies behind.
std::optional<double> finestPixel_mm(const std::vector<Vector3d>& line, const Viewpoint& view) {
  std::optional<double> finest;
  for (const Vector3d& p : line) {
    const double px = view.pixel_mm(p);
    if (px > 0 && (!finest || px < *finest)) finest = px;
  }
  return finest;
}

void addBurnt(std::string& text, const Scene& scene, const Viewpoint& view) {
  constexpr double kKerf_mm = 0.105;  // Half the width of a usual kerf.
  const auto out = std::back_inserter(text);
  for (const auto& line : scene.burnt) {
    const std::optional<double> visible_mm = finestPixel_mm(line, view);
    if (!visible_mm) continue;
    // Near the eye's plane a pixel is as small as one likes; a tenth of the kerf is fine enough.
    const double px = std::max(*visible_mm, 0.1 * kKerf_mm);
    const std::vector<Vector3d> kept = thinned(line, 0.3 * px);
    const double radius = std::max(kKerf_mm, 0.75 * px);
    fmt::format_to(out, "union {{\n");
    for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
      fmt::format_to(out, " sphere {{ {}, {:.6g} }}", vec(kept[i]), radius);
      if ((kept[i + 1] - kept[i]).norm() > 1e-6) {
        fmt::format_to(out, " cylinder {{ {}, {}, {:.6g} }}\n", vec(kept[i]), vec(kept[i + 1]), radius);
      }
    }
    fmt::format_to(out, " sphere {{ {}, {:.6g} }} texture {{ T_Burnt }} no_shadow }}\n", vec(kept.back()),
                   radius);
  }
}

}  // namespace

std::string povText(const Scene& scene, const Viewpoint& view) {
  std::string text = kPovMaterials;
  addCamera(text, view);
  addLights(text, scene, view);
  addParts(text, scene);
  addBurnt(text, scene, view);
  addGlow(text, scene, view);
  addSpot(text, scene, view);
  return text;
}

}  // namespace kerfbench::scene
