// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_content.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "hil/dieline/pdf_lexer.h"
#include "hil/dieline/pdf_operands.h"
#include "hil/dieline/pdf_painter.h"
#include "hil/dieline/pdf_path.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMostOperators = 6'000'000;  // Forms count as often as they are drawn.
constexpr std::size_t kMostTokens = 16'000'000;    // A million curves have ten million.
constexpr std::size_t kMostForms = 200'000;        // As often as they are drawn.
constexpr double kFarthestPdf_mm = 1e6;

/// What q keeps and Q brings back (ISO 32000-1, 8.4).
struct PdfState {
  Eigen::Affine2d X;  ///< User space -> mm in S.
  PdfClip clip;
  const PdfColourSpace* space{};
  std::array<double, 32> components{};
  double opacity{1.0};
  bool is_dashed{};
  bool has_mask{};
};

const PdfColourSpace kDeviceGray{PdfColourSpace::Kind::kGray, 1, {}, "DeviceGray"};
const PdfColourSpace kDeviceRgb{PdfColourSpace::Kind::kRgb, 3, {}, "DeviceRGB"};
const PdfColourSpace kDeviceCmyk{PdfColourSpace::Kind::kCmyk, 4, {}, "DeviceCMYK"};
const PdfColourSpace kPatternSpace{PdfColourSpace::Kind::kPattern, 0, {}, "Pattern"};

constexpr std::uint32_t op(std::string_view word) { return pdfOperator(word); }

/// Operators that change nothing about where strokes lie and what colour they have.
constexpr std::array kWithoutStrokes{
    op("BT"), op("ET"), op("Tc"), op("Tw"), op("Tz"), op("TL"), op("Tf"),  op("Tr"), op("Ts"), op("Td"),
    op("TD"), op("Tm"), op("T*"), op("d0"), op("d1"), op("J"),  op("j"),   op("M"),  op("ri"), op("i"),
    op("w"),  op("BI"), op("MP"), op("DP"), op("cs"), op("sc"), op("scn"), op("g"),  op("rg"), op("k")};

/// Runs the operators of the page and of the forms that it draws.
class PdfInterpreter {
 public:
  PdfInterpreter(const PdfDocument& document, FaultList& faults, PdfSink* sink)
      : document_(document),
        faults_(faults),
        operands_(faults),
        painter_(faults, sink),
        state_{document.X, PdfClip(document.page_mm), &kDeviceGray} {}

  PdfIgnored run() {
    runContent(0);
    return std::move(painter_.ignored);
  }
  [[nodiscard]] std::size_t curves() const { return painter_.curves(); }

 private:
  void runContent(std::size_t index) {
    const PdfContent& content = document_.contents[index];
    const PdfResources* outer = resources_;
    resources_ = &document_.resources[content.resources];
    const std::size_t states = states_.size();
    const std::size_t sections = sections_.size();
    const Bases bases = std::exchange(bases_, {states, sections});
    PdfLexer lexer(content.operators);
    while (true) {
      const PdfToken token = lexer.next();
      if (token.kind == PdfToken::Kind::kEnd) break;
      if (++tokens_ > kMostTokens)
        faults_.fatal(0, fmt::format("the drawing of its page has more than {} words", kMostTokens));
      if (operands_.keep(token)) continue;
      if (++operators_ > kMostOperators)
        faults_.fatal(0, fmt::format("its page is drawn by more than {} operators", kMostOperators));
      runOperator(token, lexer);
      operands_.clear();
    }
    operands_.checkEnd();
    // What is still open ends with the stream.
    if (states_.size() > states) {
      state_ = states_[states];
      states_.resize(states, state_);
    }
    sections_.resize(sections);
    bases_ = bases;
    path_.clear();
    resources_ = outer;
  }

  void runOperator(const PdfToken& token, PdfLexer& lexer) {
    const std::uint32_t code = op(token.text);
    if (runPathOperator(code) || runPaintOperator(code) || runStateOperator(code) ||
        runColourOperator(code) || runSectionOperator(code))
      return;
    if (code == op("ID")) {
      ++painter_.ignored["images"];
      if (!lexer.passInlineImage()) faults_.fatal(0, "an image within the drawing of its page has no end");
      return;
    }
    if (!isIgnoredOperator(code) && compatible_ == 0) {
      faults_.fatal(0, fmt::format("the drawing of its page has the operator {}, which there is not",
                                   inQuotes(token.text)));
    }
  }

  bool isIgnoredOperator(std::uint32_t code) {
    switch (code) {
      case op("BX"):
        ++compatible_;
        return true;
      case op("EX"):
        compatible_ -= compatible_ > 0 ? 1 : 0;
        return true;
      case op("Tj"):
      case op("TJ"):
      case op("'"):
      case op("\""):
        ++painter_.ignored["texts"];
        return true;
      case op("sh"):
        ++painter_.ignored["shadings"];
        return true;
      default:
        return std::find(kWithoutStrokes.begin(), kWithoutStrokes.end(), code) != kWithoutStrokes.end();
    }
  }

  [[nodiscard]] Vector2d placed(double x, double y) {
    const Vector2d p_mm = state_.X * Vector2d(x, y);
    if (!(p_mm.cwiseAbs().maxCoeff() <= kFarthestPdf_mm))
      faults_.fatal(
          0, fmt::format("its drawing reaches more than {:g} mm; wrong units or scale?", kFarthestPdf_mm));
    return p_mm;
  }

  bool runPathOperator(std::uint32_t code) {
    bool is_sound = true;
    switch (code) {
      case op("m"): {
        const auto v = operands_.numbers<2>("m");
        path_.moveTo(placed(v[0], v[1]));
        break;
      }
      case op("l"): {
        const auto v = operands_.numbers<2>("l");
        is_sound = path_.lineTo(placed(v[0], v[1]));
        break;
      }
      case op("c"): {
        const auto v = operands_.numbers<6>("c");
        is_sound = path_.curveTo(placed(v[0], v[1]), placed(v[2], v[3]), placed(v[4], v[5]));
        break;
      }
      case op("v"): {
        const auto v = operands_.numbers<4>("v");
        is_sound = path_.curveTo(path_.point(), placed(v[0], v[1]), placed(v[2], v[3]));
        break;
      }
      case op("y"): {
        const auto v = operands_.numbers<4>("y");
        const Vector2d end_mm = placed(v[2], v[3]);
        is_sound = path_.curveTo(placed(v[0], v[1]), end_mm, end_mm);
        break;
      }
      case op("re"):
        addRectangle();
        break;
      case op("h"):
        path_.close();
        break;
      default:
        return false;
    }
    if (!is_sound) faults_.fatal(0, "a path of its page begins without a point");
    if (path_.size() > kMostEntities)
      faults_.fatal(0, fmt::format("a path of its page has more than {} pieces", kMostEntities));
    return true;
  }

  void addRectangle() {
    const auto v = operands_.numbers<4>("re");
    path_.moveTo(placed(v[0], v[1]));
    path_.lineTo(placed(v[0] + v[2], v[1]));
    path_.lineTo(placed(v[0] + v[2], v[1] + v[3]));
    path_.lineTo(placed(v[0], v[1] + v[3]));
    path_.close();
  }

  bool runPaintOperator(std::uint32_t code) {
    enum : unsigned { kClose = 1, kFill = 2, kStroke = 4 };
    unsigned what = 0;
    switch (code) {
      case op("W"):
      case op("W*"):
        clips_ = true;
        clip_is_even_odd_ = code == op("W*");
        return true;
      case op("n"):
        break;
      case op("S"):
        what = kStroke;
        break;
      case op("s"):
        what = kClose | kStroke;
        break;
      case op("f"):
      case op("F"):
      case op("f*"):
        what = kFill;
        break;
      case op("B"):
      case op("B*"):
        what = kFill | kStroke;
        break;
      case op("b"):
      case op("b*"):
        what = kClose | kFill | kStroke;
        break;
      default:
        return false;
    }
    if ((what & kClose) != 0) path_.close();
    if (what != 0) painter_.count(path_, (what & kFill) != 0, (what & kStroke) != 0);
    if ((what & kStroke) != 0 && path_.size() > 0 && painter_.draws())
      painter_.stroke(path_, state_.clip, look());
    if (clips_) state_.clip = painter_.clipped(state_.clip, path_, clip_is_even_odd_);
    clips_ = false;
    path_.clear();
    return true;
  }

  [[nodiscard]] PdfLook look() const {
    PdfLook look;
    const auto first = state_.components.begin();
    look.paint = {state_.space,
                  {first, first + static_cast<std::ptrdiff_t>(state_.space->components)},
                  state_.is_dashed,
                  {}};
    for (const PdfMembership* section : sections_) {
      if (section == nullptr) continue;
      look.is_shown = look.is_shown && section->is_visible;
      look.paint.groups.insert(look.paint.groups.end(), section->groups.begin(), section->groups.end());
    }
    look.is_opaque = state_.opacity > 0.0;
    look.has_mask = state_.has_mask;
    return look;
  }

  bool runStateOperator(std::uint32_t code) {
    switch (code) {
      case op("q"):
        if (states_.size() >= kDeepestPdf)
          faults_.fatal(0, fmt::format("q is nested deeper than {} on its page", kDeepestPdf));
        states_.push_back(state_);
        return true;
      case op("Q"):
        // More of them than of q: viewers pass over the rest.
        if (states_.size() <= bases_.states) return true;
        state_ = states_.back();
        states_.pop_back();
        return true;
      case op("cm"): {
        const auto v = operands_.numbers<6>("cm");
        Eigen::Affine2d X;
        X.matrix() << v[0], v[2], v[4], v[1], v[3], v[5], 0, 0, 1;
        state_.X = state_.X * X;
        return true;
      }
      case op("d"):
        state_.is_dashed = operands_.hasDashes();
        return true;
      case op("gs"):
        changeState();
        return true;
      case op("Do"):
        drawObject();
        return true;
      default:
        return false;
    }
  }

  void changeState() {
    const auto found = resources_->states.find(pdfName(operands_.name()));
    if (found == resources_->states.end()) return;
    const PdfStateChange& change = found->second;
    state_.opacity = change.stroke_opacity.value_or(state_.opacity);
    state_.is_dashed = change.has_dashes.value_or(state_.is_dashed);
    state_.has_mask = change.has_mask.value_or(state_.has_mask);
  }

  void drawObject() {
    const std::string name = pdfName(operands_.name());
    const auto form = resources_->forms.find(name);
    if (form == resources_->forms.end()) {
      const auto other = resources_->others.find(name);
      if (other == resources_->others.end())
        faults_.fatal(0, fmt::format("its page draws {}, which is not in the file", inQuotes(name)));
      ++painter_.ignored[other->second == "Image" ? "images" : "objects of type " + other->second];
      return;
    }
    if (depth_ >= kDeepestNesting) {
      faults_.fatal(0, fmt::format("form {} is nested deeper than {}: does it draw itself?", inQuotes(name),
                                   kDeepestNesting));
    }
    if (++forms_ > kMostForms)
      faults_.fatal(0, fmt::format("its page draws forms more than {} times", kMostForms));
    const PdfContent& content = document_.contents[form->second];
    const PdfState outer = state_;
    PdfPath outer_path = std::exchange(path_, {});
    state_.X = state_.X * content.X;
    if (content.box) {
      PdfPath box;
      const auto corner = [&](Eigen::AlignedBox2d::CornerType at) {
        const Vector2d p = content.box->corner(at);
        return placed(p.x(), p.y());
      };
      box.moveTo(corner(Eigen::AlignedBox2d::BottomLeft));
      box.lineTo(corner(Eigen::AlignedBox2d::BottomRight));
      box.lineTo(corner(Eigen::AlignedBox2d::TopRight));
      box.lineTo(corner(Eigen::AlignedBox2d::TopLeft));
      state_.clip = painter_.clipped(state_.clip, box, false);
    }
    const std::size_t sections = sections_.size();
    if (content.membership) sections_.push_back(&*content.membership);
    ++depth_;
    runContent(form->second);
    --depth_;
    sections_.resize(sections);
    state_ = outer;
    path_ = std::move(outer_path);
  }

  void setColour(const PdfColourSpace& space, const char* name) {
    state_.space = &space;
    const auto take = [&](auto v) { std::copy(v.begin(), v.end(), state_.components.begin()); };
    if (space.components == 1) take(operands_.numbers<1>(name));
    if (space.components == 3) take(operands_.numbers<3>(name));
    if (space.components == 4) take(operands_.numbers<4>(name));
  }

  bool runColourOperator(std::uint32_t code) {
    switch (code) {
      case op("G"):
        setColour(kDeviceGray, "G");
        return true;
      case op("RG"):
        setColour(kDeviceRgb, "RG");
        return true;
      case op("K"):
        setColour(kDeviceCmyk, "K");
        return true;
      case op("CS"):
        chooseSpace();
        return true;
      case op("SC"):
      case op("SCN"):
        for (std::size_t i = 0; i < state_.space->components; ++i) {
          if (i >= operands_.count() || operands_[i].kind != PdfToken::Kind::kNumber)
            faults_.fatal(0, "a colour of its page lacks a number");
          state_.components[i] = operands_[i].number;
        }
        return true;
      default:
        return false;
    }
  }

  void chooseSpace() {
    const std::string name = pdfName(operands_.name());
    const auto found = resources_->colours.find(name);
    if (found != resources_->colours.end()) {
      state_.space = &found->second;
    } else if (name == "DeviceGray" || name == "DeviceRGB" || name == "DeviceCMYK" || name == "Pattern") {
      state_.space = name == "DeviceGray"   ? &kDeviceGray
                     : name == "DeviceRGB"  ? &kDeviceRgb
                     : name == "DeviceCMYK" ? &kDeviceCmyk
                                            : &kPatternSpace;
    } else {
      faults_.fatal(
          0, fmt::format("its page uses the colour space {}, which is not in the file", inQuotes(name)));
    }
    // Black, or the whole ink (ISO 32000-1, 8.6.3).
    state_.components.fill(state_.space->kind == PdfColourSpace::Kind::kSpot ? 1.0 : 0.0);
    if (state_.space->kind == PdfColourSpace::Kind::kCmyk) state_.components[3] = 1.0;
  }

  bool runSectionOperator(std::uint32_t code) {
    if (code == op("EMC")) {
      if (sections_.size() > bases_.sections) sections_.pop_back();
      return true;
    }
    if (code != op("BMC") && code != op("BDC")) return false;
    if (sections_.size() >= kDeepestPdf)
      faults_.fatal(0, fmt::format("marked sections of its page are nested deeper than {}", kDeepestPdf));
    const PdfMembership* section = nullptr;
    if (code == op("BDC") && operands_.count() == 2 && operands_[0].text == "OC") {
      const auto found = resources_->sections.find(pdfName(operands_.name()));
      if (found != resources_->sections.end()) section = &found->second;
    }
    sections_.push_back(section);
    return true;
  }

  const PdfDocument& document_;
  FaultList& faults_;
  PdfOperands operands_;
  PdfPainter painter_;
  PdfState state_;
  std::vector<PdfState> states_;
  std::vector<const PdfMembership*> sections_;
  /// What belongs to the contents around the one that runs; Q and EMC go no further.
  struct Bases {
    std::size_t states{};
    std::size_t sections{};
  } bases_;
  const PdfResources* resources_{};
  PdfPath path_;
  std::size_t operators_{};
  std::size_t tokens_{};
  std::size_t forms_{};
  std::size_t compatible_{};
  int depth_{};
  bool clips_{};
  bool clip_is_even_odd_{};
};

}  // namespace

PdfIgnored drawPdf(const PdfDocument& document, FaultList& faults, PdfSink& sink) {
  return PdfInterpreter(document, faults, &sink).run();
}

std::size_t countPdfStrokes(const PdfDocument& document, FaultList& faults) {
  PdfInterpreter interpreter(document, faults, nullptr);
  interpreter.run();
  return interpreter.curves();
}

}  // namespace kerfbench::dieline
