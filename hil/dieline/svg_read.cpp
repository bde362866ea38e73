// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>
#include <Eigen/LU>
#include <pugixml.hpp>

#include "hil/dieline/geometry.h"
#include "hil/dieline/layer_styles.h"
#include "hil/dieline/notes.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/svg_bombs.h"
#include "hil/dieline/svg_clip.h"
#include "hil/dieline/svg_context.h"
#include "hil/dieline/svg_css.h"
#include "hil/dieline/svg_page.h"
#include "hil/dieline/svg_shapes.h"
#include "hil/dieline/svg_style.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

bool isOneOf(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Elements that draw nothing by themselves. What `use` refers to is read at the place of the use.
bool drawsNothing(std::string_view name) {
  return isOneOf(name, {"defs", "symbol", "metadata", "title", "desc", "style", "clipPath", "mask", "pattern",
                        "marker", "filter", "linearGradient", "radialGradient", "script", "view"}) ||
         name.find(':') != std::string_view::npos;  // Data of other programs, such as sodipodi:namedview.
}

/// Things beside the lines of a drawing.
bool isSvgBesideTheLines(std::string_view name) {
  return isOneOf(name, {"text", "image", "foreignObject", "flowRoot", "video", "audio"});
}

class SvgReader {
 public:
  SvgReader(std::string text, const DrawingOptions& options, FaultList& faults)
      : text_(std::move(text)),
        options_(options),
        profile_(options.layers),
        faults_(faults),
        progress_(readingProgress(options, faults, 2 * text_.size())),
        census_(options.layers) {}

  Dieline read() {
    dieline_.path = faults_.path();
    for (std::size_t i = 0; i < text_.size(); ++i) {
      if (text_[i] == '\n') line_ends_.push_back(i);
    }
    refuseLargeXml(text_, faults_);
    // The tree takes the file's own bytes: a copy would be as large again. Only what is before the root is
    // asked for once more.
    constexpr std::size_t kLongestProlog = 1U << 20U;
    const std::string prolog = text_.substr(0, kLongestProlog);
    pugi::xml_document document;
    const auto result = document.load_buffer_inplace(text_.data(), text_.size());
    if (!result)
      faults_.fatal(lineAt(result.offset), fmt::format("is not well-formed XML: {}", result.description()));
    progress_.done(text_.size());
    const pugi::xml_node root = document.document_element();
    if (svgName(root) != "svg") faults_.fatal(lineOf(root), "the outermost element is not svg");
    index(root, 0);
    refuseSvgBombs(
        root, by_id_, [this](const pugi::xml_node& node) { return lineOf(node); }, faults_);
    const auto before_root = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, root.offset_debug()));
    const SvgPage page =
        svgPage(root, std::string_view(prolog).substr(0, before_root), options_, lineOf(root), faults_);
    px_per_inch_ = page.px_per_inch;
    if (options_.unit && !page.says_unit)
      dieline_.unsaid_unit = UnsaidUnit{lineOf(root), millimetresOf(*options_.unit)};
    SvgContext context;
    context.X = page.X;
    context.viewport = page.size;
    if (const auto inside = enter(root, context)) children(root, *inside);
    census_.refuse(faults_);
    faults_.throwIfAny();
    dieline_.notes = notes_.sentences();
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
    if (svgName(node) == "style") {
      std::string css;
      for (const pugi::xml_node& text : node.children()) css += text.value();
      const std::string media = lowered(trimmed(node.attribute("media").value()));
      if (!media.empty() && media != "all" && media != "screen")
        faults_.add(lineOf(node), fmt::format("style for the medium {} is not supported", inQuotes(media)));
      for (const std::string& unknown : sheet_.add(css)) {
        faults_.add(lineOf(node),
                    fmt::format("style selector {} is not supported; those by element, class, id and "
                                "attribute are",
                                inQuotes(unknown)));
      }
    }
    for (const pugi::xml_node& child : node.children()) index(child, depth + 1);
  }

  void checkDepth(const pugi::xml_node& node, int depth) {
    constexpr int kDeepestElement = 256;
    if (depth > kDeepestElement)
      faults_.fatal(lineOf(node), fmt::format("elements are nested deeper than {}", kDeepestElement));
  }

  std::optional<double> length(const pugi::xml_node& node, const char* name, double whole) {
    std::string fault;
    const auto value = svgLengthOf(node, name, px_per_inch_, whole, fault);
    if (!fault.empty()) faults_.add(lineOf(node), fault);
    return value;
  }

  /// Context of the element itself, or nothing where it is not displayed.
  std::optional<SvgContext> enter(const pugi::xml_node& node, const SvgContext& outer) {
    checkDepth(node, outer.depth + 1);
    if (!svgConditionsHold(node)) return std::nullopt;
    if (std::string_view(node.attribute("style").value()).find('&') != std::string_view::npos)
      faults_.add(lineOf(node),
                  "style names an entity of the DOCTYPE, which is not read; save it as plain SVG");
    SvgContext context = svgInside(outer, sheet_.styleOf(node));
    if (sheet_.isExhausted())
      faults_.fatal(lineOf(node), fmt::format("its style sheets ask for more than {} comparisons of classes",
                                              SvgSheet::kMostSteps));
    ++context.depth;
    if (!context.is_displayed) return std::nullopt;
    if (!context.faults.empty()) faults_.add(lineOf(node), context.faults);
    if (!context.clip_path.empty()) context.clips.push_back(regionOf(node, context));
    if (std::string_view(node.attribute("inkscape:groupmode").value()) == "layer") {
      context.layers.emplace_back(node.attribute("inkscape:label").value());
    }
    return context;
  }

  /// The region of a clip path of one shape that is a convex polygon; else one that clips everything partly.
  ClipRegion regionOf(const pugi::xml_node& node, const SvgContext& context) {
    ClipRegion region{{}, "clip-path " + inQuotes(context.clip_path)};
    std::string_view reference = context.clip_path;
    if (!reference.starts_with("url(")) return region;
    reference.remove_prefix(4);
    reference = trimmed(reference.substr(0, reference.find(')')));
    while (!reference.empty() &&
           (reference.front() == '"' || reference.front() == '\'' || reference.front() == '#'))
      reference.remove_prefix(1);
    while (!reference.empty() && (reference.back() == '"' || reference.back() == '\''))
      reference.remove_suffix(1);
    const auto clip = by_id_.find(std::string(reference));
    if (clip == by_id_.end()) {
      faults_.add(lineOf(node),
                  fmt::format("clip-path {}, which is not in the file", inQuotes(context.clip_path)));
      return region;
    }
    const pugi::xml_node& path = clip->second;
    if (svgName(path) != "clipPath" || path.attribute("clip-path") ||
        std::string_view(path.attribute("clipPathUnits").value()) == "objectBoundingBox")
      return region;
    std::vector<pugi::xml_node> shapes;
    for (const pugi::xml_node& child : path.children()) {
      if (child.type() == pugi::node_element && !drawsNothing(svgName(child))) shapes.push_back(child);
    }
    if (shapes.size() != 1) return region;
    SvgContext at = svgInside(svgInside(context, sheet_.styleOf(path)), sheet_.styleOf(shapes.front()));
    if (!at.clip_path.empty() || !at.is_displayed) return region;
    pugi::xml_node shape = shapes.front();
    if (svgName(shape) == "use") {
      at.X.translate(
          Eigen::Vector2d(length(shape, "x", 0).value_or(0.0), length(shape, "y", 0).value_or(0.0)));
      shape = svgUsed(shape, by_id_);
      if (shape) at = svgInside(at, sheet_.styleOf(shape));
    }
    if (!shape || !isSvgShape(svgName(shape))) return region;
    const SvgShape found = readSvgShape(shape, {0.0, px_per_inch_, at.viewport});
    if (found.faults.empty())
      region.corners_mm = convexPolygon(found.curves, at.X).value_or(region.corners_mm);
    return region;
  }

  /// The innermost Inkscape layer that the profile names, else the colour.
  [[nodiscard]] std::string layerOf(const SvgContext& context) const {
    const auto named = std::find_if(context.layers.rbegin(), context.layers.rend(),
                                    [&](const auto& label) { return hasRule(profile_, label); });
    return named == context.layers.rend() ? context.stroke : *named;
  }

  void children(const pugi::xml_node& node, const SvgContext& context) {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() == pugi::node_element) element(child, context);
    }
  }

  /// A switch shows the first of its children that can be shown.
  void choose(const pugi::xml_node& node, const SvgContext& context) {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element || drawsNothing(svgName(child)) || !svgConditionsHold(child))
        continue;
      element(child, context);
      return;
    }
  }

  void element(const pugi::xml_node& node, const SvgContext& outer) {
    const std::string_view name = svgName(node);
    if (drawsNothing(name)) return;
    progress_.done(text_.size() + static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())));
    const auto context = enter(node, outer);
    if (!context) return;
    if (name == "g" || name == "a") {
      children(node, *context);
    } else if (name == "switch") {
      choose(node, *context);
    } else if (name == "svg") {
      nested(node, node, *context);
    } else if (name == "use") {
      use(node, *context);
    } else if (!context->is_visible) {
      return;
    } else if (isSvgShape(name)) {
      shape(node, *context);
    } else if (isSvgBesideTheLines(name)) {
      notes_.add(lineOf(node), name, "ignored: no line to cut");
    } else if (processFor(profile_, layerOf(*context)) != Process::kIgnore) {
      faults_.add(lineOf(node),
                  fmt::format("element {} is no curve this reader takes (layer {}); make it a path", name,
                              inQuotes(layerOf(*context))));
    }
  }

  /// Inside of an svg or symbol that has its own viewport. `sized`: the element that gives its width and
  /// height if it gives any, the `use` or itself.
  void nested(const pugi::xml_node& node, const pugi::xml_node& sized, SvgContext context) {
    const bool is_symbol = svgName(node) == "symbol";
    const auto size = [&](const char* name, double whole) {
      const auto value = length(sized.attribute(name) ? sized : node, name, whole);
      return value.value_or(whole);
    };
    if (!is_symbol) {
      context.X.translate(Eigen::Vector2d(length(node, "x", context.viewport.x()).value_or(0.0),
                                          length(node, "y", context.viewport.y()).value_or(0.0)));
    }
    const Eigen::Vector2d outside(size("width", context.viewport.x()), size("height", context.viewport.y()));
    if (outside.x() == 0 || outside.y() == 0) return;  // The standard draws nothing.
    std::string fault;
    const auto port = svgViewport(node, outside.x(), outside.y(), fault);
    const auto fit = port ? port->fit() : std::nullopt;
    if (!fit) {
      faults_.add(lineOf(node),
                  !fault.empty()
                      ? fault
                      : "width, height, viewBox or preserveAspectRatio do not fit a drawing (slice is "
                        "not supported)");
      return;
    }
    if (!context.overflows) {
      const Eigen::Vector2d x(outside.x(), 0);
      const Eigen::Vector2d y(0, outside.y());
      const Eigen::Vector2d origin(0, 0);
      const auto corners = convexPolygon(
          {LineCurve{origin, x}, LineCurve{x, outside}, LineCurve{outside, y}, LineCurve{y, origin}},
          context.X);
      if (corners) context.clips.push_back({*corners, fmt::format("viewport of {}", svgName(node))});
    }
    context.X = context.X * *fit;
    context.viewport = port->view_box ? Eigen::Vector2d(port->view_box->sizes()) : outside;
    children(node, context);
  }

  void use(const pugi::xml_node& node, SvgContext context) {
    const pugi::xml_node found = svgUsed(node, by_id_);
    if (!found) {
      std::string_view reference = node.attribute("href").value();
      if (reference.empty()) reference = node.attribute("xlink:href").value();
      faults_.add(lineOf(node), fmt::format("use of {}, which is not in the file", inQuotes(reference)));
      return;
    }
    context.X.translate(Eigen::Vector2d(length(node, "x", context.viewport.x()).value_or(0.0),
                                        length(node, "y", context.viewport.y()).value_or(0.0)));
    const std::string_view name = svgName(found);
    if (name != "symbol" && name != "svg") {
      element(found, context);
    } else if (const auto inner = enter(found, context)) {
      nested(found, node, *inner);
    }
  }

  /// True where the stroke of a shape leaves a line on the sheet; else it is noted.
  bool isDrawn(const pugi::xml_node& node, const SvgContext& context) {
    const auto leftOut = [&](std::string_view why) {
      notes_.add(lineOf(node), fmt::format("{} {}", svgName(node), why), "left out: no line is drawn");
      return false;
    };
    if (context.is_faded || !context.is_opaque_stroke) return leftOut("with an opacity of 0");
    if (context.stroke == "none") return hasRule(profile_, "none") || leftOut("without a stroke");
    return context.has_width || leftOut("with a stroke of width 0");
  }

  /// Takes off the curves that are nothing: those that a clip hides and those without length.
  void thin(const pugi::xml_node& node, const SvgContext& context, SvgShape& shape) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < shape.curves.size(); ++i) {
      Curve curve = transformed(shape.curves[i], context.X);
      const auto* line = std::get_if<LineCurve>(&curve);
      if (line != nullptr && (line->end_mm - line->start_mm).norm() <= kNothing_mm) {
        notes_.add(lineOf(node), fmt::format("{} of length 0", svgName(node)), "left out: nothing to cut");
        continue;
      }
      bool is_hidden = false;
      for (const ClipRegion& region : context.clips) {
        const Clipped clipped = is_hidden ? Clipped::kNot : clippedBy(region, curve);
        is_hidden = is_hidden || clipped == Clipped::kWholly;
        if (clipped == Clipped::kPartly) {
          faults_.add(lineOf(node),
                      fmt::format("{} is clipped by the {}, which is not read: trim its lines, or "
                                  "release the clip",
                                  svgName(node), region.name));
        }
      }
      if (is_hidden) {
        notes_.add(lineOf(node), fmt::format("{} outside of a clip", svgName(node)), "left out: not shown");
        continue;
      }
      shape.curves[kept] = std::move(curve);
      if (kept != i) shape.parts[kept] = std::move(shape.parts[i]);
      ++kept;
    }
    shape.curves.erase(shape.curves.begin() + static_cast<std::ptrdiff_t>(kept), shape.curves.end());
  }

  void shape(const pugi::xml_node& node, const SvgContext& context) {
    constexpr double kClosing_mm = 1e-4;  // Rounding of decimals, far below what a gap is.
    if (!isDrawn(node, context)) return;
    const double scale = std::sqrt(std::abs(context.X.linear().determinant()));
    SvgShape shape =
        readSvgShape(node, {scale > 0 ? kClosing_mm / scale : 0.0, px_per_inch_, context.viewport});
    const int line = lineOf(node);
    const std::string_view name = svgName(node);
    for (const std::string& fault : shape.faults) faults_.add(line, fmt::format("{}: {}", name, fault));
    if (!(scale > 0)) faults_.add(line, fmt::format("{} is flattened to nothing by its transform", name));
    if (context.stroke.front() == '?') {
      faults_.add(line,
                  fmt::format("{}: stroke is no plain colour: {}", name, inQuotes(context.stroke.substr(1))));
      return;
    }
    thin(node, context, shape);
    if (shape.curves.empty()) return;
    const std::string layer = layerOf(context);
    const LineStyle style{context.stroke, context.is_dashed ? "dashed" : "continuous"};
    const auto process = census_.processOf(layer, style, line, name, faults_);
    if (dieline_.entities.size() + shape.curves.size() > kMostEntities)
      faults_.fatal(line, fmt::format("more than {} entities", kMostEntities));
    if (!process) return;
    for (std::size_t i = 0; i < shape.curves.size(); ++i) {
      std::string origin = fmt::format("line {}: {}", line, name);
      if (!shape.parts[i].empty()) origin += " " + shape.parts[i];
      dieline_.entities.push_back({static_cast<int>(dieline_.entities.size()), std::move(shape.curves[i]),
                                   *process, layer, std::move(origin)});
    }
  }

  std::string text_;
  const DrawingOptions& options_;
  const LayerProfile& profile_;
  FaultList& faults_;
  base::ShareProgress progress_;
  LayerCensus census_;
  NoteList notes_;
  Dieline dieline_;
  double px_per_inch_{96.0};
  std::vector<std::size_t> line_ends_;
  SvgIds by_id_;
  SvgSheet sheet_;
};

}  // namespace

Dieline readSvg(std::string text, const DrawingOptions& options, FaultList& faults) {
  return SvgReader(std::move(text), options, faults).read();
}

}  // namespace kerfbench::dieline
