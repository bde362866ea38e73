// SPDX-License-Identifier: Apache-2.0
// What the figures of a report show: deviations by their size, pins around a moment, time lines; and that
// the page can be read.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "tests/hil/report/page_checks.h"
#include "tests/hil/report/sample_report.h"

namespace kerfbench::report {
namespace {

using test::badRun;
using test::htmlOf;
using test::reportOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size()))
    ++count;
  return count;
}

TEST(Exaggeration, KeepsTheLargestDeviationSmallAgainstTheDrawing) {
  EXPECT_EQ(exaggerationFor(0.05, 300.0), 100.0);
  EXPECT_EQ(exaggerationFor(0.5, 300.0), 10.0);
  EXPECT_EQ(exaggerationFor(3.0, 300.0), 2.0);
  EXPECT_EQ(exaggerationFor(50.0, 300.0), 1.0);
  double last = 101.0;
  for (double worst_mm = 0.001; worst_mm < 100.0; worst_mm *= 1.07) {
    const double by = exaggerationFor(worst_mm, 120.0);
    EXPECT_LE(by, last) << worst_mm;
    EXPECT_TRUE(by == 1.0 || by * worst_mm <= 0.03 * 120.0 * (1.0 + 1e-12)) << worst_mm;
    last = by;
  }
}

TEST(Exaggeration, IsStatedAndHasTrueScaleBesideItWithoutAScript) {
  RunReport report = reportOf(badRun());
  const std::string html = dielineFigures(report);
  EXPECT_THAT(html, HasSubstr("deviations 20 times enlarged"));
  EXPECT_THAT(html,
              HasSubstr("<input type=radio class=scale name=scale id=scale-true><label for=scale-true>"));
  EXPECT_GT(countOf(html, "<g class=atscale>"), 0U);
  EXPECT_EQ(countOf(html, "<g class=atscale>"), countOf(html, "<g class=enlarged>"));
  EXPECT_THAT(kReportCss, HasSubstr("#scale-true:checked~.panels .atscale{display:inline}"));
  EXPECT_THAT(kReportCss, HasSubstr("#scale-true:checked~.panels .enlarged{display:none}"));
}

TEST(Exaggeration, OfAGrossErrorIsNone) {
  inspect::testing::SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, inspect::testing::kRight).calipers) c.offset_mm += 3.0;
  const std::string html = dielineFigures(reportOf(run));
  EXPECT_THAT(html, HasSubstr("true scale"));
  EXPECT_THAT(html, Not(HasSubstr("times enlarged")));
  EXPECT_THAT(html, Not(HasSubstr("<g class=atscale>")));
}

TEST(Strays, AreMarkedByTheirPlaceAndBuryNothing) {
  inspect::testing::SyntheticRun run = badRun();
  run.evidence.kerf.strays = {{1, {22, 30}, 130.0}};
  const std::string html = dielineFigures(reportOf(run));
  const auto at = html.find("<circle class=stray");
  ASSERT_NE(at, std::string::npos);
  const auto r = html.find(" r=", at);
  EXPECT_LT(std::stod(html.substr(r + 3)), 0.05 * 60.0);
}

TEST(Mosaic, ShowsAllThatTheCameraSawWithTheDielineOverIt) {
  const std::string html = htmlOf(reportOf(badRun()));
  EXPECT_THAT(html, HasSubstr("<svg class=mosaic viewBox='-2.00 -42.00 64.00 44.00'"));
  EXPECT_THAT(html, HasSubstr("A pixel is 1.00 mm wide"));
  EXPECT_THAT(kReportCss, HasSubstr("#show-dieline:not(:checked)~figure .overlay{display:none}"));
  EXPECT_EQ(mosaicFigure(reportOf(inspect::testing::SyntheticRun())), "");
}

TEST(Links, LeadFromTheDrawingToTheTableAndBack) {
  const std::string html = htmlOf(reportOf(badRun()));
  EXPECT_THAT(html, HasSubstr("<a href='#e-1-1'><title>unit 1, E1</title>"));
  EXPECT_THAT(html, HasSubstr("<tr id='e-1-1'>"));
  EXPECT_THAT(html, HasSubstr("<a href='#place-1'>place 1</a>"));
  EXPECT_THAT(html, HasSubstr("<figure id='place-1'>"));
  EXPECT_EQ(test::outsideReferences(html, "sheet-unit0.png"), "");
}

/// A report with the pins around the time of its path check.
RunReport withMoment() {
  RunReport report = reportOf(badRun());
  Moment moment{{"path"}, 0.5, 0.495, 0.505, {}, {}};
  moment.pins = {{"galvo_x_pul", false, {0.4975, 0.49751, 0.499, 0.49901}},
                 {"laser_gate", true, {0.5025}},
                 {"laser_pwm", false, {}}};
  for (int i = 0; i < 20000; ++i) moment.pins[2].toggle_s.push_back(0.4951 + 4.9e-7 * i);
  moment.followed = {{0.495, 0.499, 1, 1, 12}, {0.499, 0.5025, 1, 2, 13}};
  report.moments = {moment};
  report.program = {{12, "G01 X60.000 Y40.000 Z1 (E1)"}, {13, "G01 X0.000 <Y40.000> Z1 (E2)"}};
  return report;
}

TEST(Waveform, ShowsPinsEntityAndLineAroundTheMoment) {
  const RunReport report = withMoment();
  const std::string figure = waveformFigure(report, 0);
  EXPECT_THAT(figure, HasSubstr("<figure id='moment-1'>"));
  EXPECT_THAT(figure, HasSubstr("2 pulses"));
  EXPECT_THAT(figure, HasSubstr("high 75.0 %"));
  EXPECT_THAT(figure, HasSubstr("unit 1, E1 · line 12"));
  EXPECT_THAT(figure, HasSubstr("line 13: <code>G01 X0.000 &lt;Y40.000&gt; Z1 (E2)</code>"));
  for (const char* at : {">-5 ms<", ">+0 ms<", ">+5 ms<"}) EXPECT_THAT(figure, HasSubstr(at));
  // The gate falls half way between the moment and the end: three quarters of the width.
  EXPECT_THAT(figure, HasSubstr("H600.0V"));
  EXPECT_EQ(test::numberFaults(figure), "");
}

TEST(Waveform, StaysSmallForFastPins) {
  // 20 000 edges of the PWM are drawn as a band.
  EXPECT_LT(waveformFigure(withMoment(), 0).size(), 60'000U);
}

TEST(Waveform, MarksBothInstantsOfATimeThatIsJudged) {
  RunReport report = withMoment();
  EXPECT_THAT(waveformFigure(report, 0), Not(HasSubstr("counted from here")));
  for (inspect::Check& check : report.result.checks)
    if (check.name == "path") check.where.other_s = 0.4975;
  // 2.5 ms before the moment: a quarter of the width.
  EXPECT_THAT(waveformFigure(report, 0), HasSubstr("x1=200.0 x2=200.0"));
  EXPECT_THAT(waveformFigure(report, 0), HasSubstr("path: counted from here"));
}

TEST(Waveform, IsLinkedFromItsCheck) {
  const RunReport report = withMoment();
  const std::string html = htmlOf(report);
  EXPECT_EQ(countOf(html, "<figure id='moment-1'>"), 1U);
  EXPECT_THAT(html, HasSubstr("<a href='#moment-1'>"));
  EXPECT_EQ(test::unclosedElements(html), "");
}

/// For each level (y) of the first wire of a figure, the length over which it is drawn there.
std::map<double, double> lengthAtLevels(const std::string& figure) {
  const std::string begin = "<path class='wire' d='M";
  std::istringstream path(figure.substr(figure.find(begin) + begin.size()));
  double x = 0.0;
  double y = 0.0;
  path >> x >> y;
  std::map<double, double> lengths;
  for (char move = ' '; path >> move && move != '\'';) {
    double to = 0.0;
    path >> to;
    if (move == 'V') {
      y = to;
      continue;
    }
    lengths[y] += to - x;
    x = to;
  }
  return lengths;
}

TEST(Waveform, RestsWhereThePinRestsHoweverNarrowItsPulsesAre) {
  for (const double width_s : {2e-7, 5e-6, 7.25e-6, 8.2e-6, 2e-5}) {
    for (const bool rests_high : {false, true}) {
      RunReport report = withMoment();
      PinTrace& pin = report.moments[0].pins[0];
      pin.level = rests_high;
      pin.toggle_s.clear();
      for (int i = 0; i < 90; ++i)
        for (const double at_s : {0.0, width_s}) pin.toggle_s.push_back(0.4951 + 1e-4 * i + at_s);
      // y points down: the first row's low level is at 20, its high level at 6.
      std::map<double, double> lengths = lengthAtLevels(waveformFigure(report, 0));
      EXPECT_NEAR(lengths[20.0] + lengths[6.0], 800.0, 0.5);
      EXPECT_NEAR(lengths[rests_high ? 6.0 : 20.0] / 800.0, 1.0 - 90.0 * width_s / 0.01, 0.08)
          << width_s << (rests_high ? " high" : " low");
    }
  }
}

TEST(Motion, ShowsDeviationSpeedAndJobOverTimeWithTheMomentsMarked) {
  RunReport report = reportOf(badRun());
  for (inspect::CutResult& cut : report.result.cuts)
    for (inspect::CutFrame& frame : cut.track) frame.program_line = frame.entity + 1;
  report.program = {{7, "G01 X1"}};
  const std::string html = motionSection(report);
  EXPECT_THAT(html, HasSubstr("aria-label='The whole run'"));
  EXPECT_THAT(html, HasSubstr("aria-label='One cut'"));
  EXPECT_THAT(html, HasSubstr("<path class=devdots d='M"));
  EXPECT_THAT(html, HasSubstr("<path class=speed d='M"));
  EXPECT_THAT(html, HasSubstr("<a href='#check-stillness_x'>"));
  EXPECT_EQ(test::numberFaults(html), "");
}

SafeTimeline timeline() {
  SafeTimeline safe;
  safe.cause = "the guard was <opened>";
  safe.cause_s = 4.0;
  safe.known_s = 4.0;
  safe.laser_due_s = 4.0001;
  safe.axes_due_s = 4.0064;
  safe.word_due_s = 4.0564;
  safe.gate_off_s = 4.00005;
  safe.last_pulse_s = 4.009;
  return safe;
}

TEST(SafeTimelineTest, ShowsWhatCameWhenAgainstWhatIsAllowed) {
  RunReport report;
  report.safe = timeline();
  const std::string html = safeTimelineFigure(report);
  EXPECT_THAT(html, HasSubstr("cause: the guard was &lt;opened&gt;"));
  EXPECT_THAT(html, HasSubstr("<circle class=happened"));  // The gate, in time.
  EXPECT_THAT(html, HasSubstr("<circle class=toolate"));   // The axes, not.
  EXPECT_THAT(html, HasSubstr("<td class=num>4.000050<td class='num'>+0.05 ms<td class=num>+0.1 ms"));
  EXPECT_THAT(html, HasSubstr("<td class=num>4.009000<td class='num hit'>+9 ms"));
  // The word never came, which is late.
  EXPECT_THAT(html, HasSubstr("<td class=num>–<td class='num hit'>never"));
  EXPECT_EQ(countOf(html, "<circle"), 2U);
  EXPECT_EQ(test::numberFaults(html), "");
}

TEST(SafeTimelineTest, IsNoneWhereNothingWasProvoked) {
  RunReport report;
  EXPECT_EQ(safeTimelineFigure(report), "");
  report.safe.emplace();
  EXPECT_EQ(safeTimelineFigure(report), "");
}

TEST(PageSize, OfALargeCartonWithEveryFigureIsBelowThreeMegabytes) {
  RunReport report = withMoment();
  const std::vector<vision::EntityKerf> entities = report.kerf.entities;
  const std::vector<inspect::CutResult> cuts = report.result.cuts;
  const std::vector<inspect::EntityResult> results = report.result.entities;
  for (int k = 1; k < 40; ++k) {
    for (vision::EntityKerf kerf : entities) {
      kerf.unit += 2 * k;
      report.kerf.entities.push_back(std::move(kerf));
    }
    for (inspect::EntityResult result : results) {
      result.unit += 2 * k;
      report.result.entities.push_back(result);
    }
    report.result.cuts.insert(report.result.cuts.end(), cuts.begin(), cuts.end());
  }
  for (int k = 1; k < 12; ++k) report.moments.push_back(report.moments.front());
  EXPECT_LT(htmlOf(report).size(), 3'000'000U);
}

/// Relative luminance by WCAG 2.1 of "#rrggbb" or "#rgb".
double luminanceOf(std::string colour) {
  if (colour.size() == 4) colour = {'#', colour[1], colour[1], colour[2], colour[2], colour[3], colour[3]};
  constexpr std::array kWeights{0.2126, 0.7152, 0.0722};
  double luminance = 0.0;
  for (std::size_t i = 0; i < kWeights.size(); ++i) {
    const double c = std::stoi(colour.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
    luminance += kWeights[i] * (c <= 0.03928 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return luminance;
}
double contrastOf(const std::string& a, const std::string& b) {
  const double x = luminanceOf(a);
  const double y = luminanceOf(b);
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

/// The custom properties of each theme in the style sheet: light, dark, paper.
std::vector<std::map<std::string, std::string>> themes() {
  std::vector<std::map<std::string, std::string>> found;
  const std::string css(kReportCss);
  static const std::regex kTheme(R"re(:root\{([^}]*)\})re");
  static const std::regex kColour(R"re(--([a-z0-9]+):(#[0-9a-f]+))re");
  for (auto theme = std::sregex_iterator(css.begin(), css.end(), kTheme); theme != std::sregex_iterator();
       ++theme) {
    const std::string body = (*theme)[1];
    auto& colours = found.emplace_back(found.empty() ? std::map<std::string, std::string>() : found.front());
    for (auto c = std::sregex_iterator(body.begin(), body.end(), kColour); c != std::sregex_iterator(); ++c)
      colours[(*c)[1]] = (*c)[2];
  }
  return found;
}

TEST(Contrast, OfTextsAndLinesIsThatOfLevelAa) {
  EXPECT_NEAR(contrastOf("#000", "#ffffff"), 21.0, 1e-9);
  const auto all = themes();
  ASSERT_EQ(all.size(), 3U);
  for (const auto& colours : all) {
    for (const char* ground : {"bg", "card"}) {
      for (const char* text : {"fg", "mute", "pass", "fail", "np", "inv", "acc"})
        EXPECT_GE(contrastOf(colours.at(text), colours.at(ground)), 4.5) << text << " on " << ground;
      for (const char* line : {"nom", "b0", "b1", "b2", "b3", "b4"})
        EXPECT_GE(contrastOf(colours.at(line), colours.at(ground)), 3.0) << line << " on " << ground;
    }
  }
}

}  // namespace
}  // namespace kerfbench::report
