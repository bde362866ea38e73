// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFExc.hh>
#include <qpdf/QPDFObjectHandle.hh>

#include "hil/base/text.h"
#include "hil/dieline/pdf_bounds.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {
namespace {

constexpr const char* kEncrypted = "is encrypted; save it without a password and without restrictions";

/// A name without its slash.
std::string nameOf(QPDFObjectHandle object) { return object.isName() ? object.getName().substr(1) : ""; }

/// A dictionary's entry, or null where there is no dictionary.
QPDFObjectHandle entry(QPDFObjectHandle object, const std::string& key) {
  if (object.isStream()) object = object.getDict();
  return object.isDictionary() ? object.getKey(key) : QPDFObjectHandle::newNull();
}

template <std::size_t N>
std::optional<std::array<double, N>> numbersOf(QPDFObjectHandle object) {
  if (!object.isArray() || object.getArrayNItems() != static_cast<int>(N)) return std::nullopt;
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    auto item = object.getArrayItem(static_cast<int>(i));
    if (!item.isNumber()) return std::nullopt;
    values[i] = item.getNumericValue();
    if (!(std::abs(values[i]) <= 1e9)) return std::nullopt;
  }
  return values;
}

std::optional<Eigen::AlignedBox2d> boxOf(const QPDFObjectHandle& object) {
  const auto v = numbersOf<4>(object);
  if (!v) return std::nullopt;
  return Eigen::AlignedBox2d(Eigen::Vector2d(std::min((*v)[0], (*v)[2]), std::min((*v)[1], (*v)[3])),
                             Eigen::Vector2d(std::max((*v)[0], (*v)[2]), std::max((*v)[1], (*v)[3])));
}

PdfColourSpace spaceOf(QPDFObjectHandle object) {
  using Kind = PdfColourSpace::Kind;
  const auto ofComponents = [](long long count, std::string name) {
    const Kind kind = count == 1   ? Kind::kGray
                      : count == 3 ? Kind::kRgb
                      : count == 4 ? Kind::kCmyk
                                   : Kind::kOther;
    return PdfColourSpace{kind, static_cast<std::size_t>(std::clamp(count, 0LL, 32LL)), {}, std::move(name)};
  };
  const bool is_array = object.isArray() && object.getArrayNItems() > 0;
  const std::string family = nameOf(is_array ? object.getArrayItem(0) : object);
  if (family == "DeviceGray" || family == "CalGray") return ofComponents(1, family);
  if (family == "DeviceRGB" || family == "CalRGB") return ofComponents(3, family);
  if (family == "DeviceCMYK") return ofComponents(4, family);
  if (family == "Pattern") return {Kind::kPattern, 0, {}, family};
  if (is_array && object.getArrayNItems() > 1) {
    auto second = object.getArrayItem(1);
    if (family == "ICCBased") {
      auto count = entry(second, "/N");
      return ofComponents(count.isInteger() ? count.getIntValue() : 0, family);
    }
    if (family == "Separation") return {Kind::kSpot, 1, {nameOf(second)}, family};
    if (family == "DeviceN" && second.isArray()) {
      PdfColourSpace space{Kind::kSpot, 0, {}, family};
      for (auto& ink : second.aitems()) space.inks.push_back(nameOf(ink));
      space.components = space.inks.size();
      if (space.components <= 32) return space;
    }
  }
  return {Kind::kOther, 0, {}, family};
}

class PdfLoader {
 public:
  PdfLoader(QPDF& pdf, std::optional<int> page, PdfBudget& budget, FaultList& faults)
      : pdf_(pdf), page_(page), budget_(budget), faults_(faults) {
    document_.contents.resize(1);  // The page's.
  }

  PdfDocument load() {
    QPDFObjectHandle page = wantedPage();
    loadGroups(entry(pdf_.getRoot(), "/OCProperties"));
    placePage(page);
    auto annotations = entry(page, "/Annots");
    if (annotations.isArray()) document_.annotations = static_cast<std::size_t>(annotations.getArrayNItems());
    PdfContent content;
    auto streams = entry(page, "/Contents");
    if (streams.isArray()) {
      for (auto& stream : streams.aitems()) append(stream, content.operators);
    } else if (!streams.isNull()) {
      append(streams, content.operators);
    }
    content.resources = resourcesOf(inherited(page, "/Resources"));
    document_.contents[0] = std::move(content);
    while (!waiting_.empty()) {
      auto [index, form] = waiting_.front();
      waiting_.pop_front();
      loadForm(index, form);
    }
    return std::move(document_);
  }

 private:
  /// As many pages as are looked for, in order, and one more.
  std::vector<QPDFObjectHandle> pagesUpTo(std::size_t wanted) {
    std::vector<QPDFObjectHandle> open{entry(pdf_.getRoot(), "/Pages")};
    std::set<QPDFObjGen> seen;
    std::vector<QPDFObjectHandle> pages;
    while (!open.empty() && pages.size() <= wanted) {
      QPDFObjectHandle node = open.back();
      open.pop_back();
      if (!node.isDictionary() || (node.isIndirect() && !seen.insert(node.getObjGen()).second)) continue;
      auto kids = node.getKey("/Kids");
      if (kids.isArray()) {
        const auto items = kids.getArrayAsVector();
        open.insert(open.end(), items.rbegin(), items.rend());
      } else {
        pages.push_back(node);
      }
    }
    return pages;
  }

  QPDFObjectHandle wantedPage() {
    const auto wanted = static_cast<std::size_t>(page_.value_or(1));
    const std::vector<QPDFObjectHandle> pages = pagesUpTo(wanted);
    if (pages.empty()) {
      const auto warnings = pdf_.getWarnings();
      faults_.fatal(0, warnings.empty()
                           ? "has no page"
                           : fmt::format("has no page that can be read ({})",
                                         base::printable(warnings.front().getMessageDetail(), 100)));
    }
    if (!page_ && pages.size() > 1) {
      auto count = entry(entry(pdf_.getRoot(), "/Pages"), "/Count");
      faults_.fatal(
          0,
          fmt::format("has {} pages, and a drawing is one; say which with dieline: {{page: N}} or --page N",
                      count.isInteger() ? std::to_string(count.getIntValue()) : "several"));
    }
    if (pages.size() < wanted)
      faults_.fatal(0, fmt::format("has {} page{}, and no page {}", pages.size(),
                                   pages.size() == 1 ? "" : "s", wanted));
    return pages[wanted - 1];
  }

  static QPDFObjectHandle inherited(QPDFObjectHandle page, const std::string& key) {
    std::set<QPDFObjGen> seen;
    while (page.isDictionary()) {
      if (page.hasKey(key)) return page.getKey(key);
      if (!seen.insert(page.getObjGen()).second) break;
      page = page.getKey("/Parent");
    }
    return QPDFObjectHandle::newNull();
  }

  void placePage(const QPDFObjectHandle& page) {
    const auto media = boxOf(inherited(page, "/MediaBox"));
    if (!media || !(media->sizes().minCoeff() > 0))
      faults_.fatal(0, "its page has no MediaBox: how large is it?");
    Eigen::AlignedBox2d box = *media;
    if (const auto crop = boxOf(inherited(page, "/CropBox"))) box = crop->intersection(*media);
    if (box.isEmpty() || !(box.sizes().minCoeff() > 0))
      faults_.fatal(0, "the CropBox of its page lies outside of the MediaBox");
    auto unit = entry(page, "/UserUnit");
    const double unit_mm = (unit.isNumber() ? unit.getNumericValue() : 1.0) * 25.4 / 72;
    if (!(unit_mm > 0 && unit_mm < 1e6)) faults_.fatal(0, "the UserUnit of its page is no size");
    auto rotation = inherited(page, "/Rotate");
    const long long turns_deg = rotation.isInteger() ? (rotation.getIntValue() % 360 + 360) % 360 : 0;
    if (turns_deg % 90 != 0) faults_.fatal(0, fmt::format("its page is turned by {} degrees", turns_deg));
    document_.X = Eigen::Scaling(unit_mm) * Eigen::Rotation2Dd(-static_cast<double>(turns_deg) * M_PI / 180);
    // Quarter turns without the rounding of a sine.
    document_.X.matrix() = (document_.X.matrix().array().abs() < 1e-9).select(0.0, document_.X.matrix());
    Eigen::AlignedBox2d shown;
    for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::TopRight})
      shown.extend(document_.X * box.corner(corner));
    document_.X.pretranslate(-shown.min());
    document_.page_mm = Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), shown.sizes());
  }

  void loadGroups(const QPDFObjectHandle& properties) {
    auto all = entry(properties, "/OCGs");
    if (!all.isArray()) return;
    auto defaults = entry(properties, "/D");
    const bool is_on = nameOf(entry(defaults, "/BaseState")) != "OFF";
    for (auto& item : all.aitems()) {
      PdfGroup group;
      auto name = entry(item, "/Name");
      if (name.isString()) group.name = name.getUTF8Value();
      group.is_visible = is_on;
      auto step = entry(item, "/GTS_Metadata");
      if (!step.isDictionary()) step = item;  // As some programs wrote it before the standard was out.
      group.step_group = nameOf(entry(step, "/GTS_ProcStepsGroup"));
      group.step_type = nameOf(entry(step, "/GTS_ProcStepsType"));
      groups_.emplace(item.getObjGen(), document_.groups.size());
      document_.groups.push_back(std::move(group));
    }
    const auto set = [&](const char* key, bool value) {
      auto list = entry(defaults, key);
      if (!list.isArray()) return;
      for (auto& item : list.aitems()) {
        const auto found = groups_.find(item.getObjGen());
        if (found != groups_.end()) document_.groups[found->second].is_visible = value;
      }
    };
    set("/ON", true);
    set("/OFF", false);
  }

  PdfMembership membershipOf(const QPDFObjectHandle& object) {
    PdfMembership result;
    const auto one = groups_.find(object.getObjGen());
    if (object.isIndirect() && one != groups_.end()) {
      result.groups = {one->second};
      result.is_visible = document_.groups[one->second].is_visible;
      return result;
    }
    auto list = entry(object, "/OCGs");
    std::vector<QPDFObjectHandle> members;
    if (list.isArray()) members = list.getArrayAsVector();
    if (list.isDictionary()) members = {list};
    std::size_t shown = 0;
    for (auto& member : members) {
      const auto found = groups_.find(member.getObjGen());
      if (found == groups_.end()) continue;
      result.groups.push_back(found->second);
      shown += document_.groups[found->second].is_visible ? 1 : 0;
    }
    const std::string policy = nameOf(entry(object, "/P"));
    auto expression = entry(object, "/VE");
    if (expression.isArray()) {
      result.is_visible = holds(expression, 0);
    } else if (!result.groups.empty()) {
      result.is_visible = policy == "AllOn"    ? shown == result.groups.size()
                          : policy == "AnyOff" ? shown < result.groups.size()
                          : policy == "AllOff" ? shown == 0
                                               : shown > 0;
    }
    return result;
  }

  /// Value of a visibility expression.
  bool holds(QPDFObjectHandle expression, int depth) {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) faults_.fatal(0, "a visibility expression of its layers is nested too deeply");
    if (!expression.isArray()) {
      const auto found = groups_.find(expression.getObjGen());
      return found == groups_.end() || document_.groups[found->second].is_visible;
    }
    const int count = expression.getArrayNItems();
    const std::string word = count > 0 ? nameOf(expression.getArrayItem(0)) : "";
    if (++expressions_ > 10'000) faults_.fatal(0, "the visibility expressions of its layers have no end");
    if (word == "Not") return count < 2 || !holds(expression.getArrayItem(1), depth + 1);
    for (int i = 1; i < count; ++i) {
      if (holds(expression.getArrayItem(i), depth + 1) != (word == "And")) return word != "And";
    }
    return word == "And";
  }

  void append(QPDFObjectHandle stream, std::string& text) {
    if (!stream.isStream()) {
      faults_.fatal(0, "a part of its page's drawing is not in the file");
    }
    if (!appendUnpacked(stream, budget_, text)) {
      if (!budget_.exceeded().empty()) throw std::runtime_error(budget_.exceeded());
      faults_.fatal(0, fmt::format("a drawing of its page cannot be unpacked ({}); save it again with Flate",
                                   entry(stream, "/Filter").unparse()));
    }
    text += '\n';  // Tokens do not go on across streams.
  }

  std::size_t resourcesOf(const QPDFObjectHandle& object) {
    if (object.isIndirect()) {
      const auto known = known_resources_.find(object.getObjGen());
      if (known != known_resources_.end()) return known->second;
      known_resources_.emplace(object.getObjGen(), document_.resources.size());
    }
    const std::size_t index = document_.resources.size();
    document_.resources.emplace_back();
    PdfResources resources;
    const auto each = [&](const char* kind, auto use) {
      auto all = entry(object, kind);
      if (!all.isDictionary()) return;
      for (auto& [key, value] : all.ditems()) use(key.substr(1), value);
    };
    each("/ColorSpace", [&](std::string name, QPDFObjectHandle& o) {
      resources.colours.emplace(std::move(name), spaceOf(o));
    });
    each("/Properties", [&](std::string name, QPDFObjectHandle& o) {
      resources.sections.emplace(std::move(name), membershipOf(o));
    });
    each("/ExtGState", [&](std::string name, QPDFObjectHandle& o) {
      resources.states.emplace(std::move(name), changeOf(o));
    });
    each("/XObject", [&](std::string name, QPDFObjectHandle& o) {
      const std::string type = nameOf(entry(o, "/Subtype"));
      if (type == "Form" && o.isStream())
        resources.forms.emplace(std::move(name), formOf(o));
      else
        resources.others.emplace(std::move(name), type.empty() ? "XObject" : type);
    });
    document_.resources[index] = std::move(resources);
    return index;
  }

  static PdfStateChange changeOf(const QPDFObjectHandle& object) {
    PdfStateChange change;
    auto opacity = entry(object, "/CA");
    if (opacity.isNumber()) change.stroke_opacity = opacity.getNumericValue();
    auto dash = entry(object, "/D");
    if (dash.isArray() && dash.getArrayNItems() > 0) {
      auto lengths = dash.getArrayItem(0);
      change.has_dashes = lengths.isArray() && lengths.getArrayNItems() > 0;
    }
    auto mask = entry(object, "/SMask");
    if (!mask.isNull()) change.has_mask = nameOf(mask) != "None";
    return change;
  }

  /// A form's place among the contents; it is read later, because forms may draw forms.
  std::size_t formOf(QPDFObjectHandle& form) {
    const auto [known, is_new] = known_forms_.emplace(form.getObjGen(), document_.contents.size());
    if (is_new) {
      document_.contents.emplace_back();
      waiting_.emplace_back(known->second, form);
    }
    return known->second;
  }

  void loadForm(std::size_t index, const QPDFObjectHandle& form) {
    PdfContent content;
    append(form, content.operators);
    if (const auto m = numbersOf<6>(entry(form, "/Matrix"))) {
      content.X.matrix() << (*m)[0], (*m)[2], (*m)[4], (*m)[1], (*m)[3], (*m)[5], 0, 0, 1;
    }
    content.box = boxOf(entry(form, "/BBox"));
    auto section = entry(form, "/OC");
    if (section.isDictionary()) content.membership = membershipOf(section);
    auto resources = entry(form, "/Resources");
    // A form of PDF 1.1 takes those of the page.
    content.resources = resources.isDictionary() ? resourcesOf(resources) : document_.contents[0].resources;
    document_.contents[index] = std::move(content);
  }

  QPDF& pdf_;
  std::optional<int> page_;
  PdfBudget& budget_;
  FaultList& faults_;
  PdfDocument document_;
  std::map<QPDFObjGen, std::size_t> groups_;
  std::map<QPDFObjGen, std::size_t> known_resources_;
  std::map<QPDFObjGen, std::size_t> known_forms_;
  std::deque<std::pair<std::size_t, QPDFObjectHandle>> waiting_;
  int expressions_{};
};

}  // namespace

PdfDocument readPdfDocument(const std::string& bytes, std::optional<int> page, FaultList& faults) {
  if (bytes.size() > kLargestPdf)
    faults.fatal(0,
                 fmt::format("{} bytes are more than the limit of {} for a PDF", bytes.size(), kLargestPdf));
  PdfBudget budget;
  QPDF pdf;
  FaultList own(faults.path());  // A fault that follows from a limit is not told.
  std::string problem;
  try {
    openBounded(pdf, bytes, budget);
    if (pdf.isEncrypted()) own.fatal(0, kEncrypted);
    PdfDocument document = PdfLoader(pdf, page, budget, own).load();
    for (const QPDFExc& warning : pdf.getWarnings()) document.warnings.push_back(warning.getMessageDetail());
    if (budget.exceeded().empty()) return document;
  } catch (const QPDFExc& error) {
    problem = error.getErrorCode() == qpdf_e_password
                  ? kEncrypted
                  : fmt::format(
                        "is no sound PDF ({}); save it again in the program that drew it, or mend it "
                        "with \"qpdf IN.pdf OUT.pdf\" and look at what is left",
                        base::printable(error.getMessageDetail(), 100));
  } catch (const DielineError&) {
    if (budget.exceeded().empty()) throw;
  } catch (const std::exception& error) {
    problem = fmt::format("cannot be read ({})", base::printable(error.what(), 100));
  }
  if (!budget.exceeded().empty())
    problem = fmt::format("{}: this is not how a drawing is written", budget.exceeded());
  faults.fatal(0, problem);
}

}  // namespace kerfbench::dieline
