// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/pov_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <variant>
#include <vector>

#include "hil/scene/burnt_lines.h"
#include "hil/scene/lighting.h"
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

void addLights(std::string& text, const Scene& scene, const Viewpoint& view) {
  const Lighting lighting = lightingOf(scene, view);
  const auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      "light_source {{ {} rgb <1.0,0.97,0.92>*1.15 area_light {}, {}, 5, 5 adaptive 1 circular orient }}\n",
      vec(lighting.key_mm), vec(lighting.key_along_mm), vec(lighting.key_across_mm));
  fmt::format_to(out, "light_source {{ {} rgb <0.75,0.85,1.0>*0.30 shadowless }}\n", vec(lighting.fill_mm));
  fmt::format_to(out, "light_source {{ {} rgb 0.14 shadowless }}\n", vec(lighting.top_mm));
  fmt::format_to(
      out,
      "box {{ <-1,-1,0>, <1,1,0.01> pigment {{ rgb 1 }} finish {{ emission 1.5 ambient 0 diffuse 0 }} "
      "no_image no_shadow scale {:.6g} translate {} }}\n",
      lighting.panel_half_mm, vec(lighting.panel_mm));
  fmt::format_to(out, "fog {{ fog_type 1 distance {:.6g} rgb <0.40,0.42,0.45> }}\n", lighting.fog_mm);
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

void addBurnt(std::string& text, const Scene& scene, const Viewpoint& view) {
  const auto out = std::back_inserter(text);
  for (const BurntLine& line : burntLines(scene, view)) {
    const std::vector<Vector3d>& kept = line.points_W_mm;
    const double radius = line.radius_mm;
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
