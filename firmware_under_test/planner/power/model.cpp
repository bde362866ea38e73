// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kerfbench::planner {
namespace {

constexpr double kFullDuty = 255.0;
/// Depth below which there is no cut.
constexpr double kLeastDepth_mm = 1e-4;
/// Difference of Z that G-code's four decimals do not show.
constexpr double kSameZ = 5e-5;

std::string depthFault(const std::string& name, double depth_mm, const Material& material) {
  if (!(depth_mm >= kLeastDepth_mm) || !std::isfinite(depth_mm))
    return fmt::format("{} must be at least {:g} mm, but is {:g}", name, kLeastDepth_mm, depth_mm);
  const Curve::Point& last = material.depth.greatest();
  if (depth_mm > last.y)
    return fmt::format("{}: {:g} mm cannot be had in {}: it saturates at {:g} J/mm2, {:g} mm is the greatest",
                       name, depth_mm, material.name, last.x, last.y);
  return {};
}

}  // namespace

PowerModel::PowerModel(Material material, LaserTube laser, const PowerWish& wish)
    : material_(std::move(material)), laser_(std::move(laser)), wish_(wish) {
  std::vector<std::string> faults;
  const auto add = [&](std::string fault) {
    if (!fault.empty()) faults.push_back(std::move(fault));
  };
  const auto named = [&](Parameter parameter, const char* words) {
    return wish_.given_by == GivenBy::kScenario ? std::string(words) : nameOf(parameter, wish_.given_by);
  };
  if (!(wish_.spot_diameter_mm >= 0.01 && wish_.spot_diameter_mm <= 10.0))
    add(fmt::format("{} must be in 0.01 … 10 mm, but is {:g}",
                    named(Parameter::kSpotDiameter, "spot diameter"), wish_.spot_diameter_mm));
  const std::string depth = named(Parameter::kDepth, "depth");
  const std::string half_depth = named(Parameter::kHalfDepth, "half depth");
  add(depthFault(depth, wish_.depth_mm, material_));
  if (wish_.depth_mm > material_.depth.greatest().y && !wish_.deeper_materials.empty())
    faults.back() += fmt::format("; the library has it in material {}", wish_.deeper_materials);
  if (wish_.half_depth_mm) {
    add(depthFault(half_depth, *wish_.half_depth_mm, material_));
    if (*wish_.half_depth_mm >= wish_.depth_mm)
      add(fmt::format("{}: {:g} mm must be less than the depth of cuts ({}), {:g} mm", half_depth,
                      *wish_.half_depth_mm, depth, wish_.depth_mm));
  }
  const auto least = laser_.power.inverse(laser_.least_w);
  const auto most = laser_.power.inverse(laser_.most_w);
  if (!least || !most || !(laser_.least_w >= 0.0 && laser_.least_w < laser_.most_w) ||
      !(laser_.full_control >= *most)) {
    add(fmt::format("{}: its limits do not lie on its curve", laser_.name));
  } else {
    const double per_unit = kFullDuty / laser_.full_control;
    least_byte_ = static_cast<int>(std::ceil(*least * per_unit - 1e-9));
    most_byte_ = static_cast<int>(std::floor(*most * per_unit + 1e-9));
    if (least_byte_ >= most_byte_)
      add(fmt::format("{}: between its least and its most power lies less than a step of the PWM ({:g} {})",
                      laser_.name, 1.0 / per_unit, laser_.control_unit));
  }
  if (!faults.empty()) throw PowerError(fmt::format("{}", fmt::join(faults, "\n")));
}

PowerModel::Setting PowerModel::at(double speed_mm_s, double depth_mm) const {
  if (!(speed_mm_s > 0.0) || !std::isfinite(speed_mm_s)) throw std::domain_error("speed must be > 0");
  const auto p_ua = material_.depth.inverse(depth_mm);
  if (!p_ua) throw std::domain_error("no such depth in this material");
  Setting setting;
  setting.p_ua_j_mm2 = *p_ua;
  setting.wanted_w = *p_ua * speed_mm_s * wish_.spot_diameter_mm;
  setting.power_w = std::clamp(setting.wanted_w, laser_.least_w, laser_.most_w);
  if (setting.wanted_w < laser_.least_w) setting.limit = Limit::kLeast;
  if (setting.wanted_w > laser_.most_w) setting.limit = Limit::kMost;
  setting.control = laser_.power.inverse(setting.power_w).value();
  setting.depth_mm = setting.limit == Limit::kNone ? depth_mm : depthBy(setting.power_w, speed_mm_s);
  return setting;
}

PowerModel::Speeds PowerModel::speedsFor(double depth_mm) const {
  const auto p_ua = material_.depth.inverse(depth_mm);
  if (!p_ua || !(depth_mm > 0.0)) throw std::domain_error("no such depth in this material");
  const double per_speed = *p_ua * wish_.spot_diameter_mm;
  return {laser_.least_w / per_speed, laser_.most_w / per_speed};
}

std::uint8_t PowerModel::byteFor(double control) const {
  const double wanted = std::clamp(control / laser_.full_control, 0.0, 1.0) * kFullDuty;
  return static_cast<std::uint8_t>(
      std::clamp(static_cast<int>(std::lround(wanted)), least_byte_, most_byte_));
}

double PowerModel::powerOf(std::uint8_t byte) const {
  return laser_.power.at(byte / kFullDuty * laser_.full_control);
}

double PowerModel::depthBy(double power_w, double speed_mm_s) const {
  if (power_w <= 0.0) return 0.0;
  return material_.depth.at(power_w / (speed_mm_s * wish_.spot_diameter_mm));
}

double PowerModel::depthOf(double z, double half_z) const {
  if (wish_.half_depth_mm && z < 1.0 && std::abs(z - half_z) <= kSameZ) return *wish_.half_depth_mm;
  return z * wish_.depth_mm;
}

}  // namespace kerfbench::planner
