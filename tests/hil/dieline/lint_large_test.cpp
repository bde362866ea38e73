// SPDX-License-Identifier: Apache-2.0
// Lint of many lines: what it says is what comparing each with each says, in few steps, and it tells how far
// it is.
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/lint_items.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using Kind = LintFinding::Kind;

Dieline drawingOf(const std::vector<Curve>& curves) {
  Dieline dieline;
  dieline.path = "many.dxf";
  for (const Curve& curve : curves) {
    const int id = static_cast<int>(dieline.entities.size());
    const Process process = id % 5 == 3 ? Process::kCrease : Process::kCut;
    dieline.entities.push_back({id, curve, process, "CUT", "line " + std::to_string(id)});
  }
  return dieline;
}

/// Duplicates and overlaps by comparing each with each, in the order of the least x.
std::multiset<std::string> byEachWithEach(const Dieline& dieline) {
  std::vector<LintItem> items = lintItems(dieline);
  std::sort(items.begin(), items.end(), [](const LintItem& a, const LintItem& b) {
    const double a_mm = a.box.min().x();
    const double b_mm = b.box.min().x();
    return a_mm != b_mm ? a_mm < b_mm : a.number < b.number;
  });
  std::multiset<std::string> found;
  std::vector<bool> is_copy(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t k = i + 1; k < items.size(); ++k) {
      if (items[i].is_zero || items[k].is_zero || is_copy[i] || is_copy[k]) continue;
      const auto& [a, b] = std::minmax(
          items[i], items[k], [](const LintItem& x, const LintItem& y) { return x.number < y.number; });
      const std::string pair = std::to_string(b.number) + " " + std::to_string(a.number);
      is_copy[k] = lintSame(a, b);
      if (is_copy[k])
        found.insert("duplicate " + pair);
      else if (lintSharedLength(a, b) > kOverlap_mm)
        found.insert("overlap " + pair);
    }
  }
  return found;
}

std::multiset<std::string> byLint(const Dieline& dieline) {
  std::multiset<std::string> found;
  for (const LintFinding& finding : lintDieline(dieline)) {
    if (finding.kind != Kind::kDuplicate && finding.kind != Kind::kOverlap) continue;
    int first = -1;
    int second = -1;
    const std::size_t other = finding.message.find(" E", 1);
    first = std::stoi(finding.message.substr(1));
    second = std::stoi(finding.message.substr(other + 2));
    found.insert(std::string(lintName(finding.kind)) + " " + std::to_string(first) + " " +
                 std::to_string(second));
  }
  return found;
}

/// Lines, straight Béziers, arcs and circles between the points of a coarse grid, some a little off: much
/// lies on each other.
Dieline crowd(unsigned seed, int count) {
  std::mt19937 random(seed);
  const auto upTo = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const auto point = [&] {
    const double off_mm = upTo(3) == 0 ? 0.003 * (upTo(5) - 2) : 0.0;
    return Vector2d(4.0 * upTo(5) + off_mm, 4.0 * upTo(5) - off_mm);
  };
  std::vector<Curve> curves;
  for (int i = 0; i < count; ++i) {
    const Vector2d a = point();
    const Vector2d b = point() + Vector2d(upTo(4) == 0 ? 0.5 : 0.0, 0.0);
    switch (upTo(8)) {
      case 0:
        curves.emplace_back(ArcCurve{a, 4.0, 0.5 * upTo(6), 0.5 * (upTo(12) + 1)});
        break;
      case 1:
        curves.emplace_back(ArcCurve{a, 4.0, 1.0 * upTo(3), 2 * 3.14159265358979323846});
        break;
      case 2: {
        BezierCurve straight;
        straight.control_mm << a, a + (b - a) / 3, b - (b - a) / 3, b;
        curves.emplace_back(straight);
        break;
      }
      default:
        curves.emplace_back(LineCurve{a, b});
    }
  }
  return drawingOf(curves);
}

TEST(LintLarge, SaysWhatComparingEachWithEachSays) {
  std::size_t found = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const Dieline dieline = crowd(seed, seed % 3 == 0 ? 400 : 60);
    const auto expected = byEachWithEach(dieline);
    EXPECT_EQ(byLint(dieline), expected) << "seed " << seed;
    found += expected.size();
  }
  EXPECT_GT(found, 1000U);
}

TEST(LintLarge, CrossingLinesAreNoFault) {
  std::vector<Curve> hatch;
  std::vector<Curve> star;
  for (int i = 0; i < 20'000; ++i) {
    const double c = 0.05 * (i / 2) + (i % 2 == 0 ? 0.0 : 0.02);
    hatch.emplace_back(i % 2 == 0 ? LineCurve{{c, 0}, {c + 500, 500}} : LineCurve{{c, 500}, {c + 500, 0}});
    const double angle = 2 * 3.14159265358979323846 * i / 20'000;
    star.emplace_back(LineCurve{{0, 0}, Vector2d(std::cos(angle), std::sin(angle)) * (300.0 + i % 7)});
  }
  for (const auto& curves : {hatch, star}) {
    Dieline dieline = drawingOf(curves);
    for (Entity& entity : dieline.entities) entity.process = Process::kCut;
    const LintReport report = lintDieline(dieline, 20);
    EXPECT_EQ(report.counts.count(Kind::kOverlap), 0U);
    EXPECT_EQ(report.counts.count(Kind::kDuplicate), 0U);
  }
}

TEST(LintLarge, TellsHowFarItIs) {
  std::vector<std::string> told;
  const base::ProgressFn tell = [&](double, const std::string& what) { told.push_back(what); };
  std::vector<Curve> curves;
  for (int i = 0; i < 100'000; ++i) curves.emplace_back(LineCurve{{3.0 * i, 0}, {3.0 * i, 1}});
  (void)lintDieline(drawingOf(curves), 20, tell);
  ASSERT_GE(told.size(), 2U);
  EXPECT_THAT(told, testing::Each(testing::MatchesRegex("checking many\\.dxf, [0-9]+ %")));
  curves.resize(10'000);
  told.clear();
  (void)lintDieline(drawingOf(curves), 20, tell);
  EXPECT_THAT(told, testing::IsEmpty());
}

TEST(LintLarge, ReadingTellsHowFarItIs) {
  const std::string line = "0\nLINE\n8\nCUT\n10\n0.000000000\n20\n0.000000000\n11\n1.0\n21\n1.0";
  std::string lines;
  for (int i = 0; i < 100'000; ++i) lines += (i == 0 ? "" : "\n") + line;
  std::string elements;
  for (int i = 0; i < 120'000; ++i) elements += "<line stroke='red' x1='0' y1='0' x2='9' y2='9'/>\n";
  for (const auto& [extension, text] : {std::pair<std::string, std::string>(".dxf", dxf(lines)),
                                        std::pair<std::string, std::string>(".svg", svg(elements))}) {
    std::vector<std::string> told;
    DrawingOptions options;
    options.progress = [&](double, const std::string& what) { told.push_back(what); };
    (void)readText(extension, text, options);
    EXPECT_GE(told.size(), 2U) << extension;
    EXPECT_THAT(told, testing::Each(testing::MatchesRegex("reading kerfbench-.*, [0-9]+ %")));
    told.clear();
    (void)readText(extension, extension == ".dxf" ? dxf(line) : svg("<line x2='9' stroke='red'/>"), options);
    EXPECT_THAT(told, testing::IsEmpty());
  }
}

}  // namespace
}  // namespace kerfbench::dieline
