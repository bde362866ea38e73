// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>
#include <Eigen/LU>
#include <pugixml.hpp>

#include "hil/dieline/geometry.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/svg_shapes.h"
#include "hil/dieline/svg_style.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// What children inherit.
struct Context {
  Eigen::Affine2d X{Eigen::Affine2d::Identity()};  ///< User units here -> mm in S.
  std::string stroke{"none"};
  bool is_visible{true};
  std::vector<std::string> layers;  ///< Labels of the enclosing Inkscape layers, outermost first.
  int uses{};
  int depth{};
};

bool isOneOf(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Elements that draw nothing by themselves. What `use` refers to is read at the place of the use.
bool drawsNothing(std::string_view name) {
  return isOneOf(name, {"defs", "symbol", "metadata", "title", "desc", "style", "clipPath", "mask", "pattern",
                        "marker", "filter", "linearGradient", "radialGradient", "script", "view"}) ||
         name.find(':') != std::string_view::npos;  // Data of other programs, such as sodipodi:namedview.
}

class SvgReader {
 public:
  SvgReader(const std::string& text, const LayerProfile& profile, FaultList& faults)
      : text_(text), profile_(profile), faults_(faults) {}

  Dieline read() {
    dieline_.path = faults_.path();
    for (std::size_t i = 0; i < text_.size(); ++i) {
      if (text_[i] == '\n') line_ends_.push_back(i);
    }
    pugi::xml_document document;
    const auto result = document.load_buffer(text_.data(), text_.size());
    if (!result)
      faults_.fatal(lineAt(result.offset), fmt::format("is not well-formed XML: {}", result.description()));
    const pugi::xml_node root = document.document_element();
    if (std::string_view(root.name()) != "svg")
      faults_.fatal(lineOf(root), "the outermost element is not svg");
    index(root, 0);
    group(root, documentContext(root));
    faults_.throwIfAny();
    return std::move(dieline_);
  }

 private:
  [[nodiscard]] int lineAt(std::ptrdiff_t offset) const {
    const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0));
    return 1 +
           static_cast<int>(std::lower_bound(line_ends_.begin(), line_ends_.end(), at) - line_ends_.begin());
  }
  [[nodiscard]] int lineOf(const pugi::xml_node& node) const { return lineAt(node.offset_debug()); }

  /// Finds what `use` can name and the style sheets, wherever they stand.
  void index(const pugi::xml_node& node, int depth) {
    checkDepth(node, depth);
    if (const auto id = node.attribute("id")) by_id_.emplace(id.value(), node);
    if (std::string_view(node.name()) == "style") {
      std::string css;
      for (const pugi::xml_node& text : node.children()) css += text.value();
      if (const auto unknown = sheet_.add(css)) {
        faults_.add(lineOf(node),
                    fmt::format("style selector {} is not supported; classes are", inQuotes(*unknown)));
      }
    }
    for (const pugi::xml_node& child : node.children()) index(child, depth + 1);
  }

  void checkDepth(const pugi::xml_node& node, int depth) {
    constexpr int kDeepestElement = 256;
    if (depth > kDeepestElement)
      faults_.fatal(lineOf(node), fmt::format("elements are nested deeper than {}", kDeepestElement));
  }

  std::optional<double> length(const pugi::xml_node& node, const char* name) {
    const auto attribute = node.attribute(name);
    if (!attribute || trimmed(attribute.value()) == "100%" || trimmed(attribute.value()) == "auto")
      return std::nullopt;
    const auto value = svgLength(attribute.value());
    if (!value)
      faults_.add(lineOf(node), fmt::format("{} is no length: {}", name, inQuotes(attribute.value())));
    return value;
  }

  SvgViewport viewport(const pugi::xml_node& node, std::optional<double> width,
                       std::optional<double> height) {
    SvgViewport port;
    if (const auto attribute = node.attribute("viewBox")) {
      SvgScanner scanner(attribute.value());
      std::array<double, 4> v{};
      for (double& value : v) {
        const auto number = scanner.number();
        if (!number) {
          faults_.add(lineOf(node), fmt::format("viewBox is broken: {}", inQuotes(attribute.value())));
          return port;
        }
        value = *number;
      }
      port.view_box =
          Eigen::AlignedBox2d(Eigen::Vector2d(v[0], v[1]), Eigen::Vector2d(v[0] + v[2], v[1] + v[3]));
    }
    port.width = width.value_or(port.view_box ? port.view_box->sizes().x() : 0.0);
    port.height = height.value_or(port.view_box ? port.view_box->sizes().y() : 0.0);
    port.aspect = node.attribute("preserveAspectRatio").value();
    return port;
  }

  Eigen::Affine2d fit(const pugi::xml_node& node, const SvgViewport& port) {
    const auto X = port.fit();
    if (!X)
      faults_.add(
          lineOf(node),
          "width, height, viewBox or preserveAspectRatio do not fit a drawing (slice is not supported)");
    return X.value_or(Eigen::Affine2d::Identity());
  }

  Context documentContext(const pugi::xml_node& root) {
    const SvgViewport port = viewport(root, length(root, "width"), length(root, "height"));
    if (!(port.height > 0))
      faults_.add(lineOf(root), "svg has neither a height nor a viewBox: where is its bottom?");
    constexpr double kMmPerPx = 25.4 / 96;
    Context context;
    context.X.scale(Eigen::Vector2d(kMmPerPx, -kMmPerPx)).translate(Eigen::Vector2d(0, -port.height));
    context.X = context.X * fit(root, port);
    return context;
  }

  void apply(const pugi::xml_node& node, std::string_view name, std::string_view value, Context& context,
             bool& is_shown) {
    if (name == "stroke") {
      if (isOneOf(value, {"inherit"})) return;
      const auto colour = svgColour(value);
      if (!colour) faults_.add(lineOf(node), fmt::format("stroke is no plain colour: {}", inQuotes(value)));
      context.stroke = colour.value_or("none");
    } else if (name == "display") {
      if (value == "none") is_shown = false;
    } else if (name == "visibility") {
      if (value != "inherit") context.is_visible = value == "visible";
    } else if (name == "clip-path" || name == "mask") {
      if (value != "none" && !value.empty())
        faults_.add(lineOf(node), fmt::format("{} is not supported", name));
    } else if (name == "transform" && !value.empty() && value != "none") {
      const auto X = svgTransform(value);
      if (!X) faults_.add(lineOf(node), fmt::format("transform is broken: {}", inQuotes(value)));
      context.X = context.X * X.value_or(Eigen::Affine2d::Identity());
    }
  }

  /// Context of the element itself, or nothing where it is not displayed. Presentation attributes are the
  /// weakest, then the style sheet, then the style attribute.
  std::optional<Context> enter(const pugi::xml_node& node, Context context) {
    checkDepth(node, ++context.depth);
    if (++steps_ > kMostEntities)
      faults_.fatal(lineOf(node), fmt::format("more than {} elements", kMostEntities));
    bool is_shown = true;
    for (const char* name : {"stroke", "display", "visibility", "clip-path", "mask", "transform"}) {
      if (const auto attribute = node.attribute(name))
        apply(node, name, trimmed(attribute.value()), context, is_shown);
    }
    std::string_view classes = node.attribute("class").value();
    while (!(classes = trimmed(classes)).empty()) {
      const std::size_t end = classes.find_first_of(" \t\r\n");
      const auto rules = sheet_.classes.find(std::string(classes.substr(0, end)));
      classes.remove_prefix(end == std::string_view::npos ? classes.size() : end);
      if (rules == sheet_.classes.end()) continue;
      for (const auto& [name, value] : rules->second) apply(node, name, value, context, is_shown);
    }
    for (const auto& [name, value] : svgDeclarations(node.attribute("style").value()))
      apply(node, name, value, context, is_shown);
    if (!is_shown) return std::nullopt;
    if (std::string_view(node.attribute("inkscape:groupmode").value()) == "layer") {
      context.layers.emplace_back(node.attribute("inkscape:label").value());
    }
    return context;
  }

  /// The innermost Inkscape layer that the profile names, else the colour.
  [[nodiscard]] std::string layerOf(const Context& context) const {
    const auto named = std::find_if(context.layers.rbegin(), context.layers.rend(),
                                    [&](const auto& label) { return hasRule(profile_, label); });
    return named == context.layers.rend() ? context.stroke : *named;
  }

  void group(const pugi::xml_node& node, const Context& outer) {
    const auto context = enter(node, outer);
    if (context) children(node, *context);
  }

  void children(const pugi::xml_node& node, const Context& context) {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() == pugi::node_element) element(child, context);
    }
  }

  void element(const pugi::xml_node& node, const Context& outer) {
    const std::string_view name = node.name();
    if (drawsNothing(name)) return;
    if (isOneOf(name, {"g", "a", "switch"})) {
      group(node, outer);
    } else if (name == "svg") {
      if (const auto context = enter(node, outer))
        nested(node, *context, length(node, "width"), length(node, "height"), true);
    } else if (name == "use") {
      use(node, outer);
    } else if (const auto context = enter(node, outer); context && context->is_visible) {
      if (isSvgShape(name)) {
        shape(node, *context);
      } else if (processFor(profile_, layerOf(*context)) != Process::kIgnore) {
        faults_.add(lineOf(node),
                    fmt::format("element {} is no curve this reader takes (layer {}); make it a path", name,
                                inQuotes(layerOf(*context))));
      }
    }
  }

  /// Inside of an svg or symbol that has its own viewport.
  void nested(const pugi::xml_node& node, Context context, std::optional<double> width,
              std::optional<double> height, bool placed) {
    if (placed) {
      context.X.translate(Eigen::Vector2d(length(node, "x").value_or(0.0), length(node, "y").value_or(0.0)));
    }
    context.X = context.X * fit(node, viewport(node, width, height));
    children(node, context);
  }

  void use(const pugi::xml_node& node, const Context& outer) {
    auto context = enter(node, outer);
    if (!context) return;
    std::string_view reference = node.attribute("href").value();
    if (reference.empty()) reference = node.attribute("xlink:href").value();
    const auto target =
        reference.starts_with('#') ? by_id_.find(std::string(reference.substr(1))) : by_id_.end();
    if (target == by_id_.end()) {
      faults_.add(lineOf(node), fmt::format("use of {}, which is not in the file", inQuotes(reference)));
      return;
    }
    if (++context->uses > kDeepestNesting) {
      faults_.fatal(lineOf(node), fmt::format("use of {} is nested deeper than {}: does it hold itself?",
                                              inQuotes(reference), kDeepestNesting));
    }
    context->X.translate(Eigen::Vector2d(length(node, "x").value_or(0.0), length(node, "y").value_or(0.0)));
    const pugi::xml_node& found = target->second;
    const std::string_view name = found.name();
    if (name == "symbol" || name == "svg") {
      const auto inner = enter(found, *context);
      if (!inner) return;
      const auto width = node.attribute("width") ? length(node, "width") : length(found, "width");
      const auto height = node.attribute("height") ? length(node, "height") : length(found, "height");
      nested(found, *inner, width, height, name == "svg");
    } else {
      element(found, *context);
    }
  }

  void shape(const pugi::xml_node& node, const Context& context) {
    constexpr double kClosing_mm = 1e-4;  // Rounding of decimals, far below what a gap is.
    const double scale = std::sqrt(std::abs(context.X.linear().determinant()));
    SvgShape shape = readSvgShape(node, scale > 0 ? kClosing_mm / scale : 0.0);
    for (const std::string& fault : shape.faults)
      faults_.add(lineOf(node), fmt::format("{}: {}", node.name(), fault));
    if (!(scale > 0))
      faults_.add(lineOf(node), fmt::format("{} is flattened to nothing by its transform", node.name()));
    const std::string layer = layerOf(context);
    const auto process = processFor(profile_, layer);
    if (!process) {
      faults_.add(lineOf(node),
                  fmt::format("{} with stroke {} is on no layer for which the profile {} has a rule",
                              node.name(), inQuotes(layer), inQuotes(profile_.name)));
      return;
    }
    for (std::size_t i = 0; i < shape.curves.size(); ++i) {
      if (dieline_.entities.size() >= kMostEntities) {
        faults_.fatal(lineOf(node), fmt::format("more than {} entities", kMostEntities));
      }
      std::string origin = fmt::format("line {}: {}", lineOf(node), node.name());
      if (!shape.parts[i].empty()) origin += " " + shape.parts[i];
      dieline_.entities.push_back({static_cast<int>(dieline_.entities.size()),
                                   transformed(shape.curves[i], context.X), *process, layer,
                                   std::move(origin)});
    }
  }

  const std::string& text_;
  const LayerProfile& profile_;
  FaultList& faults_;
  Dieline dieline_;
  std::vector<std::size_t> line_ends_;
  std::unordered_map<std::string, pugi::xml_node> by_id_;
  SvgSheet sheet_;
  std::size_t steps_{};
};

}  // namespace

Dieline readSvg(const std::string& text, const LayerProfile& profile, FaultList& faults) {
  return SvgReader(text, profile, faults).read();
}

}  // namespace kerfbench::dieline
