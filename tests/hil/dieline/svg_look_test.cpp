// SPDX-License-Identifier: Apache-2.0
// What an SVG shows and how large it is: generators, the cascade of CSS, switch, symbol, nested svg, clips.
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

const LayerProfile kAll{"all", {{"*", Process::kCut}}};

/// Length of the one line in a file.
double lengthIn(const std::string& text, const DrawingOptions& options = {}) {
  const Dieline dieline = readText(".svg", text, options);
  return dieline.entities.size() == 1 ? lengthOf(dieline.entities[0].curve) : -1.0;
}
std::vector<std::string> strokes(const std::string& body) {
  std::vector<std::string> result;
  for (const Entity& entity : readText(".svg", svg(body), kAll).entities) result.push_back(entity.layer);
  return result;
}
/// Stroke of one line, as a style sheet and attributes leave it.
std::string stroke(const std::string& sheet, const std::string& attributes) {
  const auto found =
      strokes("<style>" + sheet + "</style><g class='outer'><line x2='9' " + attributes + "/></g>");
  return found.size() == 1 ? found[0] : "";
}

TEST(SvgSize, APageOfIllustratorHas72PixelsPerInch) {
  const std::string head =
      "<?xml version='1.0'?>\n<!-- Generator: Adobe Illustrator 27.0.0, SVG Export Plug-In -->\n";
  const std::string body = "<line stroke='black' x2='283.465'/>";
  EXPECT_NEAR(
      lengthIn(head + svg(body, "width='283.465px' height='283.465px' viewBox='0 0 283.465 283.465'")), 100.0,
      1e-3);
  EXPECT_NEAR(lengthIn(head + svg(body, "viewBox='0 0 283.465 283.465'")), 100.0, 1e-3);
}

TEST(SvgSize, InkscapeHad90PixelsPerInchUpTo091) {
  const auto length = [](const std::string& version, const std::string& x2) {
    return lengthIn(svg("<line stroke='black' x2='" + x2 + "'/>",
                        "width='400' height='400' inkscape:version='" + version + "'"));
  };
  EXPECT_NEAR(length("0.48.4 r9939", "354.3307"), 100.0, 1e-4);
  EXPECT_NEAR(length("0.91 r13725", "354.3307"), 100.0, 1e-4);
  EXPECT_NEAR(length("0.92.3 (2405546, 2018-03-11)", "377.9528"), 100.0, 1e-4);
  EXPECT_NEAR(length("1.2.2 (b0a8486541, 2022-12-01)", "377.9528"), 100.0, 1e-4);
  // Lengths with a unit are what they say, at any resolution.
  EXPECT_NEAR(length("0.48.4 r9939", "100mm"), 100.0, 1e-9);
  EXPECT_NEAR(length("1.2.2", "100mm"), 100.0, 1e-9);
}

TEST(SvgSize, PixelsOfNobodyAreAskedFor) {
  const std::string line = "<line stroke='black' x2='72'/>";
  for (const char* size : {"width='96px' height='96px'", "width='96' height='96'", "viewBox='0 0 96 96'",
                           "width='100%' height='100%' viewBox='0 0 96 96'"}) {
    EXPECT_THAT(faultsOf(".svg", svg(line, size)), HasSubstr("say dieline: {unit: px} for 96")) << size;
    DrawingOptions options;
    options.unit = DrawingUnit::kPixel;
    EXPECT_NEAR(lengthIn(svg(line, size), options), 72 * 25.4 / 96, 1e-9) << size;
    options.unit = DrawingUnit::kPoint;
    EXPECT_NEAR(lengthIn(svg(line, size), options), 25.4, 1e-9) << size;
    options.unit = DrawingUnit::kMillimetre;
    EXPECT_NEAR(lengthIn(svg(line, size), options), 72, 1e-9) << size;
  }
}

TEST(SvgSize, AUnitThatIsToldOverrulesTheFile) {
  DrawingOptions options;
  options.unit = DrawingUnit::kMillimetre;
  const Dieline dieline = readText(".svg",
                                   svg("<line stroke='black' x1='5' y1='5' x2='6' y2='5'/>",
                                       "width='1in' height='1in' viewBox='5 5 20 10'"),
                                   options);
  EXPECT_LT((pointAt(dieline.entities.at(0).curve, 1) - Vector2d(1, 10)).norm(), 1e-9);
}

TEST(SvgSize, OneSideFollowsFromTheOther) {
  EXPECT_NEAR(lengthIn(svg("<line stroke='black' x2='10'/>", "width='100mm' viewBox='0 0 100 50'")), 10,
              1e-9);
  EXPECT_NEAR(lengthIn(svg("<line stroke='black' x2='10'/>", "height='100mm' viewBox='0 0 100 50'")), 20,
              1e-9);
}

TEST(SvgCascade, RulesCountInTheOrderOfTheSheet) {
  // The attribute's order says nothing: a crease must not become a cut.
  EXPECT_EQ(stroke(".cut{stroke:red} .crease{stroke:blue}", "class='crease cut'"), "#0000ff");
  EXPECT_EQ(stroke(".cut{stroke:red} .crease{stroke:blue}", "class='cut crease'"), "#0000ff");
  EXPECT_EQ(stroke(".crease{stroke:blue} .cut{stroke:red}", "class='cut crease'"), "#ff0000");
}

TEST(SvgCascade, SpecificityComesBeforeOrder) {
  EXPECT_EQ(stroke("#a{stroke:red} .b{stroke:blue} line{stroke:lime}", "id='a' class='b'"), "#ff0000");
  EXPECT_EQ(stroke(".b{stroke:blue} line{stroke:lime} *{stroke:red}", "class='b'"), "#0000ff");
  EXPECT_EQ(stroke("line.b{stroke:blue} .b{stroke:lime}", "class='b'"), "#0000ff");
  EXPECT_EQ(stroke(".outer .b{stroke:blue} .b{stroke:lime}", "class='b'"), "#0000ff");
  EXPECT_EQ(stroke("g > line{stroke:blue} svg > line{stroke:lime}", ""), "#0000ff");
  EXPECT_EQ(stroke("[data-name='x']{stroke:blue} line{stroke:lime}", "data-name='x'"), "#0000ff");
  EXPECT_EQ(stroke("[class~='b']{stroke:blue}[id^='q']{stroke:red}", "class='a b' id='pq'"), "#0000ff");
}

TEST(SvgCascade, ImportantStyleAndPresentation) {
  EXPECT_EQ(stroke(".a{stroke:red !important} .a{stroke:blue}", "class='a' style='stroke:lime'"), "#ff0000");
  EXPECT_EQ(stroke(".a{stroke:red !important}", "class='a' style='stroke:lime ! important'"), "#00ff00");
  EXPECT_EQ(stroke("*{stroke:blue}", "stroke='red'"), "#0000ff");
  EXPECT_EQ(stroke(".a{stroke:blue}", "class='a' stroke='red' style='fill:none;stroke:lime'"), "#00ff00");
  EXPECT_EQ(stroke("line:hover{stroke:red}", "stroke='blue'"), "#0000ff");
  EXPECT_EQ(stroke("", "color='lime' stroke='currentColor'"), "#00ff00");
  // A transform of the style takes the place of the attribute; it does not add to it.
  EXPECT_EQ(lengthIn(svg("<line stroke='red' x2='9' transform='scale(2)' style='transform:scale(3)'/>")), 27);
}

TEST(SvgCascade, WhatCannotBeReadIsRefusedOnlyWhereItMatters) {
  const auto faults = [](const std::string& css) {
    return faultsOf(".svg", svg("<style>" + css + "</style>"));
  };
  EXPECT_THAT(faults("line:nth-child(2){stroke:red}"), HasSubstr("'line:nth-child(2)'"));
  EXPECT_THAT(faults("@media print{.a{stroke:red}}"), HasSubstr("'@media print'"));
  EXPECT_THAT(faults("@import url(other.css);"), HasSubstr("@import"));
  EXPECT_EQ(
      faults("@font-face{font-family:x;src:url(y)} text:nth-child(2){font:serif} ::selection{color:red}"),
      "");
  EXPECT_THAT(faultsOf(".svg", svg("<style>circle{r:4px}</style><circle stroke='red' r='3'/>")),
              HasSubstr("a style sheet moves its points"));
}

TEST(SvgShown, DisplayOfTheStyleOverrulesTheAttribute) {
  EXPECT_THAT(strokes("<line x2='9' stroke='red' display='none' style='display:inline'/>"),
              ElementsAre("#ff0000"));
  EXPECT_THAT(strokes("<line x2='9' stroke='red' display='inline' style='display:none'/>"), IsEmpty());
  EXPECT_THAT(strokes("<g display='none'><line x2='9' stroke='red' style='display:inline'/></g>"), IsEmpty());
  EXPECT_THAT(strokes("<g visibility='hidden'><line x2='9' stroke='red' visibility='visible'/></g>"),
              ElementsAre("#ff0000"));
  EXPECT_THAT(strokes("<style>.a{display:none}</style><g class='a'><line x2='9' stroke='red'/></g>"),
              IsEmpty());
}

TEST(SvgShown, ASwitchShowsItsFirstChildThatHolds) {
  EXPECT_THAT(strokes("<switch><line x2='9' stroke='red'/><line x2='9' stroke='blue'/></switch>"),
              ElementsAre("#ff0000"));
  EXPECT_THAT(
      strokes("<switch><foreignObject requiredExtensions='http://ns.adobe.com/AdobeIllustrator/10.0/'/>"
              "<g><line x2='9' stroke='red'/></g><g><line x2='9' stroke='blue'/></g></switch>"),
      ElementsAre("#ff0000"));
  EXPECT_THAT(
      strokes("<switch><line systemLanguage='de' x2='9' stroke='red'/>"
              "<line systemLanguage='fr, en-GB' x2='9' stroke='blue'/><line x2='9' stroke='lime'/></switch>"),
      ElementsAre("#0000ff"));
}

TEST(SvgShown, StrokesThatLeaveNoLineAreNotCutAndAreNoted) {
  const Dieline dieline = readText(
      ".svg",
      svg("<rect width='9' height='9'/><line x2='9' stroke='red' stroke-width='0'/>"
          "<line x2='9' stroke='red' style='stroke-width:0px'/><g opacity='0'><line x2='9' stroke='red'/></g>"
          "<line x2='9' stroke='red' stroke-opacity='0.0'/><line x2='9' stroke='rgba(255,0,0,0)'/>"
          "<line x2='9' stroke='red' stroke-width='.1'/>"),
      kAll);
  EXPECT_EQ(dieline.entities.size(), 1U);
  EXPECT_THAT(dieline.notes, ElementsAre(HasSubstr("line with a stroke of width 0: 2 left out"),
                                         HasSubstr("line with an opacity of 0: 2 left out"),
                                         HasSubstr("line without a stroke: 1 left out"),
                                         HasSubstr("rect without a stroke: 1 left out")));
}

TEST(SvgShown, TextAndPicturesAreCountedByName) {
  const Dieline dieline =
      readText(".svg", svg("<g stroke='red'><text>Top</text><text>Front<tspan>!</tspan></text>"
                           "<image href='a.png'/><line x2='9'/></g>"));
  EXPECT_EQ(dieline.entities.size(), 1U);
  EXPECT_THAT(dieline.notes, ElementsAre(HasSubstr("image: 1 ignored"), HasSubstr("text: 2 ignored")));
}

TEST(SvgShown, LinesOfLengthZeroAreNoted) {
  const Dieline dieline = readText(".svg", svg("<path stroke='red' d='M1 1h0M2 2h5'/>"));
  EXPECT_EQ(dieline.entities.size(), 1U);
  EXPECT_THAT(dieline.notes, ElementsAre(HasSubstr("path of length 0: 1 left out")));
}

TEST(SvgShown, DashesOfOneColourAreToldApart) {
  const std::string body =
      "<line x2='9' stroke='black'/><line y1='3' y2='3' x2='9' stroke='black' stroke-dasharray='3 1'/>";
  EXPECT_THAT(faultsOf(".svg", svg(body)), HasSubstr("{'#000000': {linetype: {continuous: …, dashed: …}}}"));
  DrawingOptions options;
  options.layers = {"scenario", {}, {{"*", {{}, {{"dashed", Process::kCrease}}, {}, Process::kCut}}}};
  const Dieline dieline = readText(".svg", svg(body), options);
  EXPECT_EQ(dieline.entities.at(0).process, Process::kCut);
  EXPECT_EQ(dieline.entities.at(1).process, Process::kCrease);
  EXPECT_THAT(strokes("<line x2='9' stroke='red' stroke-dasharray='none'/><line x2='8' stroke='red'/>"),
              ElementsAre("#ff0000", "#ff0000"));
}

TEST(SvgPlaces, SymbolAndNestedSvgWithoutSizeFillTheirViewport) {
  const std::string symbol = "<symbol id='s' viewBox='0 0 10 5'><line stroke='red' x2='10'/></symbol>";
  EXPECT_NEAR(lengthIn(svg(symbol + "<use href='#s'/>")), 100, 1e-9);
  EXPECT_NEAR(lengthIn(svg(symbol + "<use href='#s' width='50%'/>")), 50, 1e-9);
  EXPECT_NEAR(lengthIn(svg("<svg viewBox='0 0 10 5'><line stroke='red' x2='10'/></svg>")), 100, 1e-9);
  EXPECT_NEAR(lengthIn(svg("<svg viewBox='0 0 10 5'><svg width='50%' height='50%' viewBox='0 0 1 .5'>"
                           "<line stroke='red' x2='1'/></svg></svg>")),
              50, 1e-9);
  EXPECT_NEAR(lengthIn(svg("<svg x='5'><line stroke='red' x2='10'/></svg>")), 10, 1e-9);
  EXPECT_EQ(readText(".svg", svg(symbol + "<use href='#s' width='0'/>")).entities.size(), 0U);
}

TEST(SvgPlaces, ThePrefixOfSvgIsNoOtherProgram) {
  const Dieline dieline =
      readText(".svg",
               "<svg:svg xmlns:svg='http://www.w3.org/2000/svg' width='9mm' height='9mm' viewBox='0 0 9 9'>"
               "<svg:style>line{stroke:red}</svg:style><svg:g><svg:line x2='5'/></svg:g></svg:svg>");
  EXPECT_EQ(dieline.entities.size(), 1U);
}

TEST(SvgClip, AClipThatClipsNothingIsNone) {
  const auto faults = [](const std::string& clip, const std::string& shape) {
    return faultsOf(".svg", svg("<clipPath id='c'>" + clip +
                                "</clipPath><g clip-path='url(#c)' stroke='red'>" + shape + "</g>"));
  };
  const std::string page = "<rect width='100' height='50'/>";
  EXPECT_EQ(faults(page, "<line x2='100' y2='50'/><circle cx='20' cy='20' r='20'/>"), "");
  EXPECT_THAT(faults(page, "<circle cx='20' cy='20' r='20.1'/>"),
              HasSubstr("circle is clipped by the clip-path"));
  EXPECT_EQ(faults("<path d='M0 0V50H100V0Z' transform='translate(1 0)'/>", "<line x1='1' x2='9'/>"), "");
  EXPECT_THAT(faults("<circle r='99'/>", "<line x2='9'/>"), HasSubstr("clip-path 'url(#c)'"));
  EXPECT_EQ(faults("<circle r='99'/>", "<text>only text is clipped</text>"), "");
  EXPECT_THAT(faultsOf(".svg", svg("<g mask='url(#m)'><line stroke='red' x2='9'/></g>")),
              HasSubstr("mask 'url(#m)'"));
  // Four corners that cross themselves are no rectangle.
  EXPECT_THAT(faults("<path d='M0 0L100 50V0L0 50Z'/>", "<line x1='1' y1='25' x2='9' y2='25'/>"),
              HasSubstr("is clipped by"));
}

TEST(SvgClip, WhatIsWhollyOutsideIsNotShown) {
  const Dieline dieline = readText(".svg", svg("<clipPath id='c'><rect width='10' height='10'/></clipPath>"
                                               "<g clip-path='url(#c)' stroke='red'><line x2='9'/>"
                                               "<line x1='20' x2='30' y1='5' y2='5'/></g>"));
  EXPECT_EQ(dieline.entities.size(), 1U);
  EXPECT_THAT(dieline.notes, ElementsAre(HasSubstr("line outside of a clip: 1 left out")));
  EXPECT_THAT(faultsOf(".svg", svg("<svg width='10' height='10'><line stroke='red' x2='11'/></svg>")),
              HasSubstr("clipped by the viewport of svg"));
  EXPECT_EQ(
      faultsOf(".svg",
               svg("<svg width='10' height='10' overflow='visible'><line stroke='red' x2='11'/></svg>")),
      "");
}

TEST(SvgShown, EntitiesOfTheDoctypeAreRefused) {
  EXPECT_THAT(
      faultsOf(".svg", "<!DOCTYPE svg [<!ENTITY st0 'stroke:#000;'>]>" + svg("<line style='&st0;' x2='9'/>")),
      HasSubstr("names an entity of the DOCTYPE"));
}

}  // namespace
}  // namespace kerfbench::dieline
