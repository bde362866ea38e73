// SPDX-License-Identifier: Apache-2.0
// The real second reader: it agrees on drawings that are read right, and parts where a reading is made wrong.
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/witness/compare.h"
#include "tests/hil/dieline/pdf_writer.h"
#include "tests/hil/witness/programs.h"

namespace kerfbench::witness {
namespace {

namespace fs = std::filesystem;
using dieline::DrawingOptions;
using dieline::dxf;
using dieline::svg;
using testing::HasSubstr;
using Kind = Testimony::Kind;

class Witness : public testing::Test {
 protected:
  void SetUp() override {
    if (!canImport("ezdxf, svgelements"))
      GTEST_SKIP() << "python3-ezdxf or python3-svgelements is not installed";
  }
  static Testimony asked(const fs::path& drawing, const DrawingOptions& options = {}) {
    return testimonyOf(dieline::readDieline(drawing, options), options, realWitness());
  }
  static void expectAgrees(const std::string& extension, const std::string& text,
                           const DrawingOptions& options = {}) {
    const dieline::TempFile file(extension, text);
    const Testimony testimony = asked(file.path(), options);
    EXPECT_EQ(testimony.kind, Kind::kAgrees) << allSentences(testimony) << text;
  }
};

DrawingOptions withRules(const std::vector<std::vector<std::string>>& rules) {
  DrawingOptions options;
  options.layers = {"test", {}};
  for (const auto& rule : rules) {
    const std::vector<std::string> path(rule.begin(), rule.end() - 1);
    EXPECT_EQ(dieline::addLayerRule(options.layers, path, rule.back()), "");
  }
  return options;
}

TEST_F(Witness, AgreesOnOneFixtureOfEachFormat) {
  for (const char* name : {"tuck-end-carton-window.dxf", "reader/entities-R12.dxf",
                           "reader/entities-R2018.dxf", "label-60x40-turned.svg", "label-60x40-paths.svg"}) {
    const Testimony testimony = asked(dieline::fixture(name));
    EXPECT_EQ(testimony.kind, Kind::kAgrees) << name << ": " << allSentences(testimony);
  }
}

TEST_F(Witness, AgreesOnEveryFixture) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(dieline::fixture(""))) {
    if (entry.path().string().find("generate") != std::string::npos) continue;
    if (entry.path().extension() != ".dxf" && entry.path().extension() != ".svg") continue;
    const Testimony testimony = asked(entry.path());
    EXPECT_EQ(testimony.kind, Kind::kAgrees) << entry.path() << ": " << allSentences(testimony);
    ++count;
  }
  EXPECT_GE(count, 15);
}

/// Layer 0 and BYBLOCK in blocks in blocks, mirrored, stretched, in rows and columns.
TEST_F(Witness, AgreesOnBlocks) {
  const std::string blocks =
      "0|BLOCK|2|IN|10|1|20|2|0|LINE|8|0|10|0|20|0|11|7|21|3|0|ARC|8|0|62|0|10|2|20|2|40|3|50|20|51|200|0|"
      "ENDBLK|"
      "0|BLOCK|2|OUT|10|0|20|0|0|INSERT|8|0|2|IN|10|5|20|5|41|-1|42|2|50|30|0|CIRCLE|8|CREASE|10|1|20|1|40|2|"
      "0|ENDBLK";
  expectAgrees(
      ".dxf",
      dxf("0|INSERT|8|CUT|2|OUT|10|40|20|20|50|15|0|INSERT|8|PERF|2|IN|10|-40|20|0|70|3|71|2|44|9|45|11", "",
          blocks));
}

TEST_F(Witness, AgreesOnWhatIsNotShown) {
  const std::string layers =
      "0|TABLE|2|LAYER|0|LAYER|2|OFF|70|0|62|-1|6|CONTINUOUS|0|LAYER|2|ICE|70|1|62|3|6|CONTINUOUS|0|ENDTAB";
  const std::string drawing =
      dieline::dxfLines("0|SECTION|2|TABLES|" + layers + "|0|ENDSEC") +
      dxf("0|LINE|8|CUT|10|0|20|0|11|30|21|0|0|LINE|8|OFF|10|0|20|9|11|30|21|9|0|LINE|8|ICE|10|0|"
          "20|8|11|30|21|8|0|LINE|8|CUT|60|1|10|0|20|7|11|30|21|7|0|TEXT|8|CUT|10|0|20|0|40|2|1|a|"
          "0|POINT|8|CUT|10|90|20|90|0|LINE|8|NOTES|10|0|20|70|11|30|21|70");
  expectAgrees(".dxf", drawing);
}

TEST_F(Witness, AgreesOnUnits) {
  const std::string line = "0|LINE|8|CUT|10|0|20|0|11|3|21|1";
  expectAgrees(".dxf", dxf(line, "9|$INSUNITS|70|1"));
  expectAgrees(".dxf", dxf(line, "9|$INSUNITS|70|5"));
  expectAgrees(".dxf", dxf(line, "9|$MEASUREMENT|70|0"));
  const std::string path = "<path d='M10 10L90 20' stroke='#ff0000'/>";
  expectAgrees(".svg",
               svg(path, "width='4in' height='2in' viewBox='5 5 100 50' preserveAspectRatio='xMinYMax'"));
  expectAgrees(".svg", svg(path, "width='200' height='100' inkscape:version='0.91 r13725'"));
  expectAgrees(".svg", svg(path, "width='200' height='100' inkscape:version='1.2'"));
  expectAgrees(".svg",
               "<!-- Generator: Adobe Illustrator 24.0 -->\n" + svg(path, "width='200' height='100'"));
}

/// Told units, scales, turns and shifts are carried out by both.
TEST_F(Witness, AgreesOnWhatIsTold) {
  DrawingOptions told;
  told.unit = dieline::DrawingUnit::kInch;
  told.scale = 1.0 / 3;
  told.turn_deg = -33.3;
  told.shift_mm = {-12.345, 1e-5};
  expectAgrees(".dxf", dxf("0|ELLIPSE|8|CUT|10|5|20|5|11|3|21|1|40|0.3|41|0.2|42|5", "9|$INSUNITS|70|4"),
               told);
  told.unit = dieline::DrawingUnit::kPoint;
  expectAgrees(".svg",
               svg("<ellipse cx='30' cy='20' rx='10' ry='3' stroke='red' transform='rotate(20)'/>",
                   "width='200' height='100' viewBox='0 10 100 50'"),
               told);
}

TEST_F(Witness, AgreesOnCurves) {
  expectAgrees(".dxf", dxf("0|LWPOLYLINE|100|AcDbEntity|8|CUT|100|AcDbPolyline|90|3|70|1|10|0|20|0|42|0.7|10|"
                           "30|20|0|42|-0.2|10|30|20|20|"
                           "0|ARC|8|CUT|10|50|20|0|40|7|50|300|51|40|210|0|220|0|230|-1|"
                           "0|SPLINE|100|AcDbEntity|8|CUT|100|AcDbSpline|70|8|71|3|72|9|73|5|40|0|40|0|40|0|"
                           "40|0|40|0.5|40|1|40|1|40|1|40|"
                           "1|10|0|20|0|30|0|10|10|20|"
                           "30|30|0|10|20|20|-30|30|0|10|30|20|30|30|0|10|40|20|0|30|0|"
                           "0|SPLINE|100|AcDbEntity|8|CREASE|100|AcDbSpline|70|4|71|2|72|6|73|3|40|0|40|0|40|"
                           "0|40|1|40|1|40|1|41|1|41|0."
                           "70710678|41|1|10|0|20|0|30|0|"
                           "10|10|20|0|30|0|10|10|20|10|30|0",
                           "9|$ACADVER|1|AC1015|9|$INSUNITS|70|4"));
  expectAgrees(
      ".svg",
      svg("<path fill='none' stroke='blue' d='M5 5q5 8 10 0t10 0a6 3 20 1 0 5 5l1-1h3v4c1 2 3 4 9-2s4 5 6 9z"
          "m10 10 5 5'/><rect x='5' y='20' width='12' height='9' rx='2' stroke='#f00' fill='none'/>"
          "<polygon points='40,5 50,5 45,9' stroke='#f00'/><polyline points='60 5 70 5 65 9' "
          "stroke='#f00'/>"));
}

TEST_F(Witness, AgreesOnStyles) {
  expectAgrees(
      ".svg",
      svg("<style>.a{stroke:#00f} .b{stroke:red!important} #c{display:none} rect{stroke-width:0}</style>"
          "<g stroke='red'><path class='a' d='M1 1h9'/><path class='b a' d='M1 2h9' style='stroke:blue'/>"
          "<path id='c' d='M1 3h9'/><path d='M1 4h9' visibility='hidden'/><path d='M1 5h9' "
          "style='opacity:0'/>"
          "<rect x='1' y='6' width='5' height='5'/><path d='M1 7h9' stroke='none'/><text>a</text></g>"));
  const auto rules =
      withRules({{"#ff0000", "linetype", "dashed", "perforation"}, {"#ff0000", "other", "cut"}});
  expectAgrees(".svg",
               svg("<path stroke='red' d='M1 1h9'/><path stroke='red' stroke-dasharray='2 1' d='M1 3h9'/>"),
               rules);
}

TEST_F(Witness, AgreesOnUsesAndViewports) {
  expectAgrees(
      ".svg",
      svg("<use xlink:href='#later' x='5' y='5'/><switch><g systemLanguage='de'><path stroke='red' d='M0 "
          "1h50'/></g>"
          "<path stroke='red' d='M0 2h40'/><path stroke='red' d='M0 3h30'/></switch>"
          "<symbol id='s' viewBox='0 0 10 10' overflow='visible'><path stroke='blue' d='M1 1h7'/></symbol>"
          "<use xlink:href='#s' x='20' y='20' width='20' height='10'/>"
          "<svg x='60' y='10' width='20' height='20' viewBox='0 0 40 40' overflow='visible'><circle cx='20' "
          "cy='20' r='9' "
          "stroke='red'/></svg><defs><path id='later' stroke='red' d='M0 0l5 5'/></defs>"));
  expectAgrees(
      ".svg",
      svg("<g inkscape:groupmode='layer' inkscape:label='crease'><path stroke='#123456' d='M1 1h9'/></g>"));
}

TEST_F(Witness, AgreesOnRulesByColourAndLinetype) {
  const std::string ltypes =
      "0|TABLE|2|LTYPE|0|LTYPE|2|DASHED|70|0|3||72|65|73|0|40|0|0|ENDTAB|0|TABLE|2|LAYER|0|LAYER|2|A|70|0|62|"
      "3|6|"
      "CONTINUOUS|0|ENDTAB";
  const std::string drawing =
      dieline::dxfLines("0|SECTION|2|TABLES|" + ltypes + "|0|ENDSEC") +
      dxf("0|LINE|8|A|10|0|20|0|11|30|21|0|0|LINE|8|A|62|1|10|0|20|9|11|30|21|9|0|LINE|8|A|6|DASHED|10|"
          "0|20|8|11|30|21|8|0|LINE|8|A|62|30|420|255|10|0|20|7|11|30|21|7");
  expectAgrees(".dxf", drawing,
               withRules({{"A", "color", "1", "cut"},
                          {"A", "color", "#0000ff", "crease"},
                          {"A", "linetype", "DASHED", "perforation"},
                          {"A", "other", "half-cut"}}));
}

/// A layer's name in the code page of an older file.
TEST_F(Witness, AgreesOnNamesOfACodePage) {
  const auto rules = withRules({{"Schn\xE4tt", "cut"}});
  expectAgrees(
      ".dxf",
      dxf("0|LINE|8|Schn\xE4tt|10|0|20|0|11|3|21|1", "9|$ACADVER|1|AC1009|9|$DWGCODEPAGE|3|ANSI_1252"),
      rules);
}

TEST_F(Witness, NothingAgreesWithNothing) {
  const Testimony testimony = [] {
    const dieline::TempFile file(".dxf", dxf(""));
    return asked(file.path());
  }();
  EXPECT_EQ(testimony.kind, Kind::kAgrees);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("0 layers, 0.000 mm"));
}

TEST_F(Witness, AgreesOnPdf) {
  if (!fs::exists("/usr/bin/mutool")) GTEST_SKIP() << "mutool (package mupdf-tools) is not installed";
  const std::string spot =
      "/ColorSpace << /C [/Separation /Dieline /DeviceCMYK << /FunctionType 2 /Domain [0 1] /C0 [0 0 0 0] "
      "/C1 [0 1 0 0] /N 1 >>] >>";
  dieline::PdfPage page;
  page.resources = spot;
  expectAgrees(".pdf",
               dieline::pdfPage("/C CS 1 SCN 10 10 300 200 re S 0 0 1 RG 20 20 m 90 200 130 20 220 120 c S "
                                "0 G q 0.5 0.1 -0.1 0.5 100 100 cm 0 0 m 99 9 l s Q",
                                page));
}

TEST_F(Witness, LooksAtTheSamePage) {
  if (!fs::exists("/usr/bin/mutool")) GTEST_SKIP() << "mutool (package mupdf-tools) is not installed";
  const auto leaf = [](int content) {
    return fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 720 720] /Contents {} 0 R >>", content);
  };
  const dieline::TempFile file(
      ".pdf",
      dieline::pdfOf({"<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R 5 0 R] /Count 2 >>",
                      leaf(4), dieline::pdfStream("1 0 0 RG 0 0 m 72 0 l S"), leaf(6),
                      dieline::pdfStream("1 0 0 RG 9 9 m 144 0 l S")}));
  DrawingOptions first;
  first.page = 1;
  DrawingOptions second;
  second.page = 2;
  EXPECT_EQ(asked(file.path(), second).kind, Kind::kAgrees);
  EXPECT_EQ(testimonyOf(dieline::readDieline(file.path(), first), second, realWitness()).kind, Kind::kParts);
}

/// Reading by one set of options and witnessing by another is a misreading.
TEST_F(Witness, PartsWhereSizeOrPlaceIsMisread) {
  const fs::path drawing = dieline::fixture("label-60x40.dxf");
  const auto partsBy = [&](const DrawingOptions& misread) {
    const Testimony testimony = testimonyOf(dieline::readDieline(drawing, misread), {}, realWitness());
    EXPECT_EQ(testimony.kind, Kind::kParts) << allSentences(testimony);
    return allSentences(testimony);
  };
  DrawingOptions misread;
  misread.unit = dieline::DrawingUnit::kInch;
  EXPECT_THAT(partsBy(misread), HasSubstr("this reader finds 5348."));
  misread = {};
  misread.scale = 1 + 1e-5;
  EXPECT_THAT(partsBy(misread), HasSubstr("layer 'CUT' (cut)"));
  misread = {};
  misread.shift_mm = {0, 0.0011};
  EXPECT_THAT(partsBy(misread), HasSubstr("reach over"));
  misread = {};
  misread.turn_deg = 90;
  (void)partsBy(misread);
}

/// One entity of the carton, read in every way that it should not.
TEST_F(Witness, PartsWhereOneEntityIsMisread) {
  const fs::path drawing = dieline::fixture("tuck-end-carton-window.dxf");
  const dieline::Dieline right = dieline::readDieline(drawing, DrawingOptions{});
  const SecondReading second =
      secondReadingFrom(runBounded({"/usr/bin/python3", "-I", "-B", realWitness().script.string(),
                                    "--format=dxf", drawing.string()},
                                   {})
                            .output);
  ASSERT_TRUE(compareReadings(right, second, {}, dieline::FileFormat::kDxf).partings.empty());
  using Change = std::function<void(dieline::Dieline&)>;
  const std::vector<Change> misreadings{
      [](dieline::Dieline& d) { d.entities.erase(d.entities.begin() + 7); },
      [](dieline::Dieline& d) { d.entities.push_back(d.entities[7]); },
      [](dieline::Dieline& d) { d.entities[7].process = dieline::Process::kPerforation; },
      [](dieline::Dieline& d) { d.entities[7].process = dieline::Process::kIgnore; },
      [](dieline::Dieline& d) { d.entities[7].layer = "OTHER"; },
      [](dieline::Dieline& d) {
        for (dieline::Entity& e : d.entities) {
          if (auto* arc = std::get_if<dieline::ArcCurve>(&e.curve)) arc->sweep_rad *= 1.0001;
        }
      },
      [](dieline::Dieline& d) {
        for (dieline::Entity& e : d.entities) {
          if (auto* arc = std::get_if<dieline::ArcCurve>(&e.curve)) arc->radius_mm = NAN;
        }
      },
      [](dieline::Dieline& d) { d.entities.clear(); }};
  for (std::size_t i = 0; i < misreadings.size(); ++i) {
    dieline::Dieline wrong = right;
    misreadings[i](wrong);
    EXPECT_FALSE(compareReadings(wrong, second, {}, dieline::FileFormat::kDxf).partings.empty()) << i;
  }
}

/// What the second reader does not follow is told, and never passed over.
TEST_F(Witness, ADrawingThatItDoesNotFollowIsNotWitnessed) {
  const dieline::TempFile file(".svg", svg("<style>g > path {stroke: red}</style><g><path d='M1 1h9'/></g>"));
  const Testimony testimony = asked(file.path());
  EXPECT_EQ(testimony.kind, Kind::kParts);
  EXPECT_THAT(allSentences(testimony), HasSubstr("does not follow 'style selector g > path'"));
}

TEST(WitnessOfCf2, ThereIsNoneAndThatIsSaid) {
  const dieline::TempFile file(".cf2", "$BOF\nV2\nMAIN,BOX\nUM\nL,2,1,0,0,0,50,0,0,0\nEND\n$EOF\n");
  const Testimony testimony =
      testimonyOf(dieline::readDieline(file.path(), DrawingOptions{}), DrawingOptions{}, realWitness());
  EXPECT_EQ(testimony.kind, Kind::kParts);
  EXPECT_THAT(testimony.sentences.front(), HasSubstr("there is no second reader for '.cf2'"));
  EXPECT_FALSE(hasWitness(file.path()));
}

}  // namespace
}  // namespace kerfbench::witness
