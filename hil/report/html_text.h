// SPDX-License-Identifier: Apache-2.0
#pragma once

// Pieces of text and figures that the reports share. Private to hil/report and its tests.

#include <string>
#include <string_view>

#include "hil/report/run_report.h"
#include "twin/base/image.h"

namespace kerfbench::hil {

/// Escapes text for HTML and attribute values; bytes that are not UTF-8 text are the caller's matter.
std::string escapeHtml(std::string_view text);
std::string base64(std::string_view bytes);
/// "data:image/png;base64,…"
std::string pngDataUri(const GrayImage& image);

/// The verdict in one plain sentence, and why the controller stopped by itself, if it did.
std::string verdictSentence(const RunReport& report);
/// CSS class of a verdict: "pass", "fail", "invalid", "notproven".
std::string_view verdictClass(Verdict verdict);

/// The page's style sheet.
extern const std::string_view kReportCss;

// Figures; empty where there is nothing to show.
std::string gaugeSvg(const Check& check);
std::string dielineFigures(const RunReport& report);
std::string worstPlaces(const RunReport& report);
std::string stillnessFigures(const RunReport& report);
std::string pulseFigures(const RunReport& report);
/// What the measurement is worth: budgets, layers, corners and ends.
std::string uncertaintySection(const RunReport& report);
/// Steps that the machine lost, below the verdict.
std::string lostStepsBanner(const RunReport& report);
/// Preset, seed, model, what was drawn, what was lost.
std::string modelSection(const RunReport& report);

}  // namespace kerfbench::hil
