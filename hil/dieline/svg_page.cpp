// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_page.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

constexpr double kCssPxPerInch = 96.0;

bool isPhysical(std::string_view length) {
  const std::string text = lowered(trimmed(length));
  constexpr std::array<std::string_view, 5> kUnits{"mm", "cm", "in", "pt", "pc"};
  return std::any_of(kUnits.begin(), kUnits.end(),
                     [&](std::string_view unit) { return text.ends_with(unit); });
}

/// Pixels per inch of the program that wrote the file, where it is known.
std::optional<double> pxPerInchOfProgram(const pugi::xml_node& root, std::string_view prolog) {
  if (prolog.find("Adobe Illustrator") != std::string_view::npos) return 72.0;
  std::string_view version = root.attribute("inkscape:version").value();
  if (version.empty()) return root.attribute("sodipodi:version") ? std::optional(90.0) : std::nullopt;
  const auto part = [&]() -> std::optional<int> {
    const std::size_t end = std::min(version.find_first_not_of("0123456789"), version.size());
    const auto number = parsedNumber<int>(version.substr(0, end));
    version.remove_prefix(std::min(end + 1, version.size()));
    return number;
  };
  const auto major = part();
  const auto minor = part();
  if (!major) return std::nullopt;
  return *major == 0 && minor.value_or(0) <= 91 ? 90.0 : kCssPxPerInch;
}

/// Puts the bottom left corner of a box of user units at the origin, and turns y upwards.
Eigen::Affine2d standing(const Eigen::AlignedBox2d& box, double mm_per_unit) {
  Eigen::Affine2d X = Eigen::Affine2d::Identity();
  X.scale(Eigen::Vector2d(mm_per_unit, -mm_per_unit))
      .translate(Eigen::Vector2d(-box.min().x(), -box.max().y()));
  return X;
}

}  // namespace

std::optional<double> svgLengthOf(const pugi::xml_node& node, const char* name, double px_per_inch,
                                  double whole, std::string& fault) {
  const std::string_view text = trimmed(node.attribute(name).value());
  if (text.empty() || text == "auto") return std::nullopt;
  auto value = svgLength(text, px_per_inch);
  if (text.ends_with('%')) {
    value = parsedNumber<double>(text.substr(0, text.size() - 1));
    if (value) *value *= whole / 100;
  }
  if (!value) fault = fmt::format("{} is no length: {}", name, inQuotes(text));
  return value;
}

std::optional<SvgViewport> svgViewport(const pugi::xml_node& node, std::optional<double> width,
                                       std::optional<double> height, std::string& fault) {
  SvgViewport port;
  if (const auto attribute = node.attribute("viewBox")) {
    SvgScanner scanner(attribute.value());
    std::array<double, 4> v{};
    for (double& value : v) {
      const auto number = scanner.number();
      if (!number) {
        fault = fmt::format("viewBox is broken: {}", inQuotes(attribute.value()));
        return std::nullopt;
      }
      value = *number;
    }
    port.view_box =
        Eigen::AlignedBox2d(Eigen::Vector2d(v[0], v[1]), Eigen::Vector2d(v[0] + v[2], v[1] + v[3]));
    const Eigen::Vector2d size(v[2], v[3]);
    if (!width && height && size.y() > 0) width = *height * size.x() / size.y();
    if (width && !height && size.x() > 0) height = *width * size.y() / size.x();
    if (!width && !height) {
      width = size.x();
      height = size.y();
    }
  }
  port.width = width.value_or(0.0);
  port.height = height.value_or(0.0);
  port.aspect = node.attribute("preserveAspectRatio").value();
  return port;
}

SvgPage svgPage(const pugi::xml_node& root, std::string_view prolog, const DrawingOptions& options, int line,
                FaultList& faults) {
  SvgPage page;
  const bool is_physical =
      isPhysical(root.attribute("width").value()) || isPhysical(root.attribute("height").value());
  const auto known = pxPerInchOfProgram(root, prolog);
  page.says_unit = known || is_physical;
  if (!options.unit && !page.says_unit) {
    faults.add(line,
               "svg gives its size in px only, and does not say which program wrote it: 96, 90 and 72 px per "
               "inch are usual; say dieline: {unit: px} for 96 (CSS, Inkscape since 0.92), {unit: pt} for 72 "
               "(Adobe Illustrator), {unit: px, scale: 1.0666666667} for 90 (Inkscape up to 0.91), or {unit: "
               "mm} where a unit is a millimetre");
    return page;
  }
  page.px_per_inch = known.value_or(kCssPxPerInch);
  std::string fault;
  const auto length = [&](const char* name) -> std::optional<double> {
    if (trimmed(root.attribute(name).value()).ends_with('%')) return std::nullopt;
    return svgLengthOf(root, name, page.px_per_inch, 0.0, fault);
  };
  const auto width = length("width");
  const auto height = length("height");
  const auto port = svgViewport(root, width, height, fault);
  if (!fault.empty()) faults.add(line, fault);
  if (!port) return page;
  if (!(port->height > 0)) {
    faults.add(line, "svg has neither a height nor a viewBox: where is its bottom?");
    return page;
  }
  const Eigen::AlignedBox2d outside(Eigen::Vector2d(0, 0), Eigen::Vector2d(port->width, port->height));
  page.size = port->view_box.value_or(outside).sizes();
  if (options.unit) {
    page.X = standing(port->view_box.value_or(outside), millimetresOf(*options.unit));
    return page;
  }
  const auto fit = port->fit();
  if (!fit) {
    faults.add(line,
               "width, height, viewBox or preserveAspectRatio do not fit a drawing (slice is not supported)");
    return page;
  }
  page.X = standing(outside, 25.4 / page.px_per_inch) * *fit;
  return page;
}

}  // namespace kerfbench::dieline
