// SPDX-License-Identifier: Apache-2.0
// What a DXF shows and what it is for: layers, colours, linetypes, visibility, clips, and things beside the
// lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A line on a layer with the groups of its look, at a height by which it is known.
std::string lineAt(int y, const std::string& layer, const std::string& look = "") {
  return "0|LINE|8|" + layer + (look.empty() ? "" : "|" + look) + "|10|0|20|" + std::to_string(y) +
         "|11|9|21|" + std::to_string(y);
}
/// A file with a table of layers, "name|flags|colour" and more groups each.
std::string withLayers(const std::vector<std::string>& layers, const std::string& entities,
                       const std::string& blocks = "", const std::string& objects = "") {
  std::string text = dxfLines("0|SECTION|2|TABLES|0|TABLE|2|LAYER");
  for (const std::string& layer : layers) text += dxfLines("0|LAYER|2|" + layer);
  text += dxfLines("0|ENDTAB|0|ENDSEC");
  if (!blocks.empty()) text += dxfLines("0|SECTION|2|BLOCKS|" + blocks + "|0|ENDSEC");
  text += dxfLines("0|SECTION|2|ENTITIES|" + entities + "|0|ENDSEC");
  if (!objects.empty()) text += dxfLines("0|SECTION|2|OBJECTS|" + objects + "|0|ENDSEC");
  return text + dxfLines("0|EOF");
}
DrawingOptions ruled(const std::string& layer, const StyleRules& rules) {
  DrawingOptions options;
  options.layers = {"scenario", {}, {{layer, rules}}};
  return options;
}
/// Heights of the lines read.
std::vector<int> heights(const Dieline& dieline) {
  std::vector<int> result;
  for (const Entity& entity : dieline.entities)
    result.push_back(static_cast<int>(pointAt(entity.curve, 0).y()));
  return result;
}
std::vector<Process> processes(const Dieline& dieline) {
  std::vector<Process> result;
  for (const Entity& entity : dieline.entities) result.push_back(entity.process);
  return result;
}

TEST(DxfLook, ColoursOfOneLayerThatNoRuleTellsApartAreRefusedWithTheRule) {
  const std::string file = dxf(lineAt(0, "0", "62|1") + "|" + lineAt(1, "0", "62|5"));
  const std::string faults = faultsOf(".dxf", file);
  EXPECT_THAT(faults, HasSubstr("layer '0' mixes lines that are drawn differently"));
  EXPECT_THAT(faults, HasSubstr("layers: {'0': {color: {1: …, 5: …}}}"));
  EXPECT_THAT(faults, HasSubstr("layers: {'0': {other: cut}}"));
  StyleRules rules;
  rules.colour = {{"#ff0000", Process::kCut}, {"#0000ff", Process::kCrease}};
  EXPECT_THAT(processes(readText(".dxf", file, ruled("*", rules))),
              ElementsAre(Process::kCut, Process::kCrease));
  EXPECT_THAT(processes(readText(".dxf", file, ruled("0", {{}, {}, {}, Process::kHalfCut}))),
              ElementsAre(Process::kHalfCut, Process::kHalfCut));
}

TEST(DxfLook, LinetypesOfOneLayerAreToldApart) {
  const std::string file = dxf(lineAt(0, "0") + "|" + lineAt(1, "0", "6|DASHED"));
  EXPECT_THAT(faultsOf(".dxf", file), HasSubstr("{'0': {linetype: {continuous: …, dashed: …}}}"));
  StyleRules rules;
  rules.linetype = {{"dashed", Process::kPerforation}};
  rules.other = Process::kCut;
  EXPECT_THAT(processes(readText(".dxf", file, ruled("0", rules))),
              ElementsAre(Process::kCut, Process::kPerforation));
  rules.other.reset();
  EXPECT_THAT(faultsOf(".dxf", file, ruled("0", rules)), HasSubstr("linetype 'continuous', for which"));
}

TEST(DxfLook, ColourAndLinetypeThatDisagreeAreRefusedUnlessARuleNamesBoth) {
  const std::string file = dxf(lineAt(0, "0", "62|1|6|DASHED"));
  StyleRules rules;
  rules.colour = {{"#ff0000", Process::kCut}};
  rules.linetype = {{"dashed", Process::kPerforation}};
  EXPECT_THAT(faultsOf(".dxf", file, ruled("0", rules)),
              HasSubstr("is cut by its colour and perforation by"));
  rules.both = {{"#ff0000 dashed", Process::kCrease}};
  EXPECT_THAT(processes(readText(".dxf", file, ruled("0", rules))), ElementsAre(Process::kCrease));
}

TEST(DxfLook, WhatLooksTheSameIsNoMixture) {
  // The colour of the layer, said by the layer, by the line, and as a true colour; a layer that is ignored.
  EXPECT_EQ(faultsOf(".dxf", withLayers({"CUT|70|0|62|1|6|CONTINUOUS"},
                                        lineAt(0, "CUT") + "|" + lineAt(1, "CUT", "62|1|6|Continuous") + "|" +
                                            lineAt(2, "CUT", "62|12|420|16711680") + "|" +
                                            lineAt(3, "NOTES", "62|2") + "|" + lineAt(4, "NOTES", "62|3"))),
            "");
  EXPECT_THAT(
      faultsOf(".dxf", withLayers({"CUT|70|0|62|1"}, lineAt(0, "CUT") + "|" + lineAt(1, "CUT", "62|2"))),
      HasSubstr("color: {1: …, 2: …}"));
}

TEST(DxfLook, AnExactRuleIsNearerThanTheRuleForAllOthers) {
  DrawingOptions options = ruled("*", {{{"#ff0000", Process::kCrease}}, {}, {}, {}});
  options.layers.rules = {{"KNIFE", Process::kCut}};
  EXPECT_THAT(
      processes(readText(".dxf", dxf(lineAt(0, "knife", "62|1") + "|" + lineAt(1, "ANY", "62|1")), options)),
      ElementsAre(Process::kCut, Process::kCrease));
}

TEST(DxfLook, BlocksTakeLayerZeroAndByBlockFromTheirInsert) {
  const std::string blocks = "0|BLOCK|2|A|10|0|20|0|" + lineAt(0, "0", "62|0|6|BYBLOCK") + "|" +
                             lineAt(1, "0") + "|" + lineAt(2, "CREASE", "62|0") + "|0|ENDBLK";
  StyleRules rules;
  rules.both = {{"#00ff00 dashed", Process::kPerforation}, {"#0000ff hidden", Process::kHalfCut}};
  DrawingOptions options = ruled("KNIFE", rules);
  options.layers.rules = {{"CREASE", Process::kCrease}};
  const Dieline dieline = readText(
      ".dxf",
      withLayers({"KNIFE|70|0|62|5|6|HIDDEN"}, "0|INSERT|8|KNIFE|62|3|6|DASHED|2|A|10|0|20|0", blocks),
      options);
  EXPECT_THAT(processes(dieline), ElementsAre(Process::kPerforation, Process::kHalfCut, Process::kCrease));
  EXPECT_EQ(dieline.entities[0].layer, "KNIFE");
}

TEST(DxfLook, WhatIsNotShownIsNotCutAndIsNoted) {
  const Dieline dieline = readText(
      ".dxf",
      withLayers({"ICE|70|1|62|7", "OFF|70|0|62|-7", "DRAFT|70|0|62|7|290|0", "SHUT|70|4|62|7"},
                 lineAt(0, "ICE") + "|" + lineAt(1, "OFF") + "|" + lineAt(2, "DRAFT") + "|" +
                     lineAt(3, "CUT", "60|1") + "|" + lineAt(4, "SHUT") + "|" + lineAt(5, "CUT", "60|0")),
      LayerProfile{"all", {{"*", Process::kCut}}});
  EXPECT_THAT(heights(dieline), ElementsAre(4, 5));
  EXPECT_THAT(dieline.notes,
              ElementsAre(HasSubstr("LINE on layer 'DRAFT', which is not to be plotted: 1 left out"),
                          HasSubstr("LINE on layer 'OFF', which is switched off: 1 left out"),
                          HasSubstr("LINE on the frozen layer 'ICE': 1 left out"),
                          HasSubstr("LINE that is invisible: 1 left out")));
}

TEST(DxfLook, ACutLayerThatIsNotPlottedIsAskedFor) {
  // Dielines are often kept off the plate, so this may be the very cut.
  const std::string file = withLayers({"CUT|70|0|62|7|290|0"}, lineAt(0, "CUT"));
  EXPECT_THAT(faultsOf(".dxf", file), HasSubstr("not to be plotted; say layers: {CUT: cut}"));
  const Dieline read = readText(".dxf", file, LayerProfile{"scenario", {{"CUT", Process::kCut}}});
  EXPECT_EQ(read.entities.size(), 1U);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("read, for a rule names the layer")));
}

TEST(DxfLook, InsertsOnHiddenLayers) {
  const std::string blocks =
      "0|BLOCK|2|A|10|0|20|0|" + lineAt(0, "0") + "|" + lineAt(1, "CREASE") + "|0|ENDBLK";
  const auto read = [&](const std::string& insert) {
    return heights(readText(".dxf", withLayers({"ICE|70|1|62|7", "OFF|70|0|62|-7"}, insert, blocks),
                            LayerProfile{"all", {{"*", Process::kCut}}}));
  };
  EXPECT_THAT(read("0|INSERT|8|ICE|2|A|10|0|20|0"), IsEmpty());
  EXPECT_THAT(read("0|INSERT|8|OFF|2|A|10|0|20|0"), ElementsAre(1));  // Layer 0 becomes the insert's.
  EXPECT_THAT(read("0|INSERT|8|CUT|60|1|2|A|10|0|20|0"), IsEmpty());
  EXPECT_THAT(read("0|INSERT|8|CUT|2|A|10|0|20|0"), ElementsAre(0, 1));
}

TEST(DxfLook, AClippedInsertIsRefusedByName) {
  const std::string blocks = "0|BLOCK|2|WINDOW|10|0|20|0|" + lineAt(0, "CUT") + "|0|ENDBLK";
  const std::string insert = "0|INSERT|5|A1|102|{ACAD_XDICTIONARY|360|B1|102|}|8|CUT|2|WINDOW|10|0|20|0";
  const auto objects = [](const std::string& enabled) {
    return "0|DICTIONARY|5|B1|330|A1|3|ACAD_FILTER|360|C1|0|DICTIONARY|5|C1|330|B1|3|SPATIAL|360|D1|"
           "0|SPATIAL_FILTER|5|D1|330|C1|70|2|10|0|20|0|10|5|20|5|71|" +
           enabled;
  };
  EXPECT_THAT(faultsOf(".dxf", withLayers({}, insert, blocks, objects("1"))),
              HasSubstr("INSERT of block 'WINDOW' is clipped (XCLIP)"));
  EXPECT_EQ(faultsOf(".dxf", withLayers({}, insert, blocks, objects("0"))), "");
  EXPECT_EQ(faultsOf(".dxf", withLayers({}, "0|INSERT|5|A1|8|CUT|2|WINDOW|10|0|20|0", blocks, objects("1"))),
            "");
}

TEST(DxfLook, ThingsBesideTheLinesAreCountedByName) {
  const Dieline dieline = readText(
      ".dxf", dxf("0|TEXT|8|CUT|10|0|20|0|1|hello|0|MTEXT|8|A|1|b|0|TEXT|8|B|1|c|0|POINT|8|CUT|10|1|20|1|"
                  "0|DIMENSION|8|CUT|10|0|20|0|0|HATCH|8|CUT|0|IMAGE|8|CUT|" +
                  lineAt(3, "CUT")));
  EXPECT_THAT(heights(dieline), ElementsAre(3));
  EXPECT_THAT(dieline.notes, ElementsAre(HasSubstr("DIMENSION: 1 ignored"), HasSubstr("HATCH: 1 ignored"),
                                         HasSubstr("IMAGE: 1 ignored"), HasSubstr("MTEXT: 1 ignored"),
                                         HasSubstr("POINT: 1 ignored"), HasSubstr("TEXT: 2 ignored")));
  // What is geometry and cannot be read is refused all the same.
  EXPECT_THAT(faultsOf(".dxf", dxf("0|3DSOLID|8|CUT")), HasSubstr("3DSOLID is not a curve"));
  EXPECT_EQ(faultsOf(".dxf", dxf("0|3DSOLID|8|NOTES")), "");
}

TEST(DxfLook, SmallFaultsAreMendedAndNoted) {
  const Dieline dieline =
      readText(".dxf", dxf("0|LWPOLYLINE|8|CUT|90|1|70|0|10|1|20|1|0|LINE|8|CUT|10|2|20|2|11|2|21|2|"
                           "0|ELLIPSE|8|CUT|10|5|20|5|11|1|21|0|40|3|41|0|42|6.283185307179586"));
  ASSERT_EQ(dieline.entities.size(), 1U);
  const auto box = dieline.bounds();
  EXPECT_LT((box.min() - Vector2d(4, 2)).norm(), 1e-9);
  EXPECT_LT((box.max() - Vector2d(6, 8)).norm(), 1e-9);
  EXPECT_THAT(dieline.notes, ElementsAre(HasSubstr("ELLIPSE with a ratio above 1: 1 read"),
                                         HasSubstr("LINE of length 0: 1 left out"),
                                         HasSubstr("LWPOLYLINE with fewer than 2 vertices: 1 left out")));
  EXPECT_THAT(faultsOf(".dxf", dxf("0|LINE|8|CUT|10|1,5|20|0|11|1|21|0")), HasSubstr("is no number: '1,5'"));
}

TEST(DxfLook, TheFrameOfATextIsNoCut) {
  const std::string frame = "0|LWPOLYLINE|5|9f|8|CUT|90|3|70|1|10|1|20|1|10|9|20|1|10|9|20|5";
  const std::string text =
      "0|MTEXT|5|87|8|CUT|10|1|20|1|1|note|1001|ACAD|1000|ACAD_MTEXT_TEXT_BORDERS_BEGIN|1070|5|1005|9F|"
      "1000|ACAD_MTEXT_TEXT_BORDERS_END|1000|OTHER_BEGIN|1005|A1";
  const Dieline dieline =
      readText(".dxf", dxf(text + "|" + frame + "|0|LINE|5|A1|8|CUT|10|0|20|0|11|9|21|0"));
  EXPECT_EQ(dieline.entities.size(), 1U) << "the line, which another part of the text's data names, is cut";
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("frame of a text: 1 ignored")));
  EXPECT_EQ(readText(".dxf", dxf(frame)).entities.size(), 3U) << "a frame of no text";
}

TEST(DxfLook, ArcsAndCirclesWithoutRadiusAreDots) {
  const Dieline dieline = readText(
      ".dxf", dxf(lineAt(2, "CUT") + "|0|ARC|8|CUT|10|0|20|0|40|0|50|0|51|90|0|CIRCLE|8|CUT|10|0|20|0|40|0"));
  EXPECT_EQ(dieline.entities.size(), 1U);
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("ARC of radius 0: 1 left out")));
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("CIRCLE of radius 0: 1 left out")));
}

TEST(DxfLook, ALayerWithoutARuleIsToldOnce) {
  const std::string faults = faultsOf(".dxf", dxf(lineAt(2, "SLOT") + "|" + lineAt(3, "SLOT") + "|" +
                                                  lineAt(4, "SLOT") + "|" + lineAt(5, "SAFE")));
  EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 1) << faults;
  EXPECT_THAT(faults,
              HasSubstr(":6: LINE on layer 'SLOT' (and 2 more on this layer), for which the profile"));
  EXPECT_THAT(faults, HasSubstr("LINE on layer 'SAFE', for which the profile"));
}

TEST(DxfLook, AUnitThatContradictsItselfIsAskedFor) {
  const std::string file = dxf(lineAt(2, "CUT"), "9|$INSUNITS|70|0|9|$MEASUREMENT|70|0");
  EXPECT_THAT(faultsOf(".dxf", file), HasSubstr("dieline: {unit: mm} or {unit: in}"));
  DrawingOptions options;
  options.unit = DrawingUnit::kInch;
  EXPECT_NEAR(pointAt(readText(".dxf", file, options).entities.at(0).curve, 1).x(), 9 * 25.4, 1e-9);
  EXPECT_THAT(faultsOf(".dxf", dxf(lineAt(2, "CUT"), "9|$INSUNITS|70|2")), HasSubstr("dieline: {unit: mm}"));
}

TEST(Placing, ScalesAndTurnsAboutTheOriginThenShifts) {
  DrawingOptions options;
  options.unit = DrawingUnit::kCentimetre;
  options.scale = 2;
  options.turn_deg = 90;
  options.shift_mm = {1, 2};
  const Dieline dieline = readText(".dxf", dxf(lineAt(3, "CUT")), options);
  EXPECT_LT((pointAt(dieline.entities.at(0).curve, 1) - Vector2d(-60 + 1, 180 + 2)).norm(), 1e-9);
  options.scale = 1e9;
  EXPECT_THAT(faultsOf(".dxf", dxf(lineAt(3, "CUT")), options), HasSubstr("wrong units or scale?"));
}

TEST(Placing, ArgumentsOfACommandAreRules) {
  DrawingArguments arguments;
  EXPECT_TRUE(arguments.empty());
  arguments.unit = "in";
  arguments.layers = {"CUT=cut", "*/color/1=crease", "*/linetype/Dashed=perforation",
                      "*/both/red solid=ignore", "*/other=half-cut"};
  const DrawingOptions options = drawingOptionsFrom(arguments);
  EXPECT_EQ(options.unit, DrawingUnit::kInch);
  EXPECT_EQ(options.layers.rules.at("CUT"), Process::kCut);
  const StyleRules& others = options.layers.styled.at("*");
  EXPECT_EQ(others.colour.at("#ff0000"), Process::kCrease);
  EXPECT_EQ(others.linetype.at("dashed"), Process::kPerforation);
  EXPECT_EQ(others.both.at("#ff0000 continuous"), Process::kIgnore);
  EXPECT_EQ(others.other, Process::kHalfCut);
  for (const char* rule : {"CUT", "CUT=burn", "*/color/256=cut", "*/color/reddish=cut", "*/both/1=cut",
                           "*/else=cut", "a/b/c/d=cut"}) {
    arguments.layers = {rule};
    EXPECT_THROW((void)drawingOptionsFrom(arguments), DielineError) << rule;
  }
  arguments.layers.clear();
  arguments.unit = "feet";
  EXPECT_THROW((void)drawingOptionsFrom(arguments), DielineError);
}

TEST(Placing, UnitsHaveOneNameEach) {
  for (const char* name : {"mm", "cm", "in", "pt", "px"}) EXPECT_TRUE(drawingUnitFromName(name)) << name;
  EXPECT_FALSE(drawingUnitFromName("m"));
  EXPECT_DOUBLE_EQ(millimetresOf(DrawingUnit::kPoint) * 72, 25.4);
  EXPECT_DOUBLE_EQ(millimetresOf(DrawingUnit::kPixel) * 96, 25.4);
}

}  // namespace
}  // namespace kerfbench::dieline
