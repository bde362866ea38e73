// SPDX-License-Identifier: Apache-2.0
#pragma once

// Pieces of text and figures that the pages of runs, of the gauge and of a head's calibration share.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/base/text.h"
#include "hil/report/run_report.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::report {

/// A table of a report ends after so many rows.
inline constexpr std::size_t kMostRows = 100;

using base::escapeHtml;
std::string base64(std::string_view bytes);
/// "data:image/png;base64,…"
std::string pngDataUri(const GrayImage& image);

/// The verdict in one plain sentence, after the likely cause of a bad one, and why the controller stopped by
/// itself, if it did.
std::string verdictSentence(const RunReport& report);
/// The same without the cause.
std::string sentenceOfVerdict(const RunReport& report);
/// CSS class of a verdict: "pass", "fail", "invalid", "notproven".
std::string_view verdictClass(inspect::Verdict verdict);

/// The page's style sheet.
extern const std::string_view kReportCss;

/// Doctype, head with the style sheet and `more_css`, up to and with <main>; `title` is text, `more_head`
/// HTML.
std::string htmlPageHead(std::string_view title, std::string_view more_css = {},
                         std::string_view more_head = {});
/// The script of the report, which sorts and filters tables. Without it a page lacks nothing else.
extern const std::string_view kReportScript;
/// Tells the browser that the page may load nothing, and run nothing but kReportScript.
std::string pageRules();
/// The end of the page.
extern const std::string_view kHtmlPageEnd;
/// A section with a heading and sectionId(); nothing where the body is empty. `body` is HTML.
std::string htmlSection(std::string_view title, const std::string& body);
/// The anchor of a section: "worst-places" of "Worst places".
std::string sectionId(std::string_view title);
/// A body that the screen shows when its label is ticked, and paper always; nothing where it is empty. It
/// takes no script. `label` is text, `body` HTML.
std::string htmlFold(std::string_view id, std::string_view label, const std::string& body);
/// A body that may be wider than a phone: it scrolls by itself. `label` is text for screen readers.
std::string scrolled(std::string_view label, const std::string& body);
/// A row of a table of facts; nothing where the value is empty. Both are text.
std::string htmlRow(std::string_view key, const std::string& value, bool code = false);
/// "Machine <b>m</b> · Seed <b>1</b>"; what is empty is left out. All are text.
std::string htmlFacts(const std::vector<std::pair<std::string_view, std::string>>& facts);

/// Lengths are coloured by quarters of a limit: classes b0 … b3 within it, b4 beyond; k0 … k4 of the legend.
inline constexpr std::size_t kLimitBins = 5;
std::size_t limitBin(double offset_mm, double limit_mm);
/// The entries of the legend, without the element around them.
std::string limitLegend(double limit_mm);

// Figures; empty where there is nothing to show.
std::string gaugeSvg(const inspect::Check& check);
std::string dielineFigures(const RunReport& report);
/// What the drawing has the laser do, and what lint finds in it.
std::string drawingFigure(const RunReport& report);
std::string worstPlaces(const RunReport& report);
/// One of the worst places, `index` of KerfScan::patches; `anchored`: others lead to this one.
std::string placeFigure(const RunReport& report, std::size_t index, bool anchored);
/// The picture that shows a place.
std::optional<std::size_t> placeNear(const RunReport& report, const inspect::Whereabouts& where);
/// All that the kerf camera saw of the worst unit, with the dieline over it; needs dielineSymbol().
std::string mosaicFigure(const RunReport& report);
/// The drawing once, for all figures that use it; before them on the page.
std::string dielineSymbol(const RunReport& report);
/// A place on the whole drawing; needs dielineSymbol().
std::string placeOnDieline(const RunReport& report, const inspect::Whereabouts& where);
/// How many times deviations are drawn enlarged, so that the largest does not bury the drawing: a step of
/// 1, 2, 5 from 1 to 100. Both > 0.
double exaggerationFor(double largest_mm, double drawing_mm);
/// "e-1-14": the anchor of an entity's row.
std::string entityAnchor(int unit, int entity);
std::string entityTable(const RunReport& report);
/// Whether the table of entities has it: it ends after the worst.
bool hasEntityRow(const RunReport& report, int unit, int entity);
std::string stillnessFigures(const RunReport& report);
std::string pulseFigures(const RunReport& report);
/// What the measurement is worth: budgets, layers, corners and ends.
std::string uncertaintySection(const RunReport& report);
/// Steps that the machine lost, below the verdict.
std::string lostStepsBanner(const RunReport& report);
/// Preset, seed, model, what was sampled, what was lost.
std::string modelSection(const RunReport& report);
/// Measured spot against the model's; empty without a real camera.
std::string partingSection(const RunReport& report);

}  // namespace kerfbench::report
