// SPDX-License-Identifier: Apache-2.0
// The same drawing as DXF, CF2 and PDF, written by programs that have nothing of the readers, and read by
// others besides. A test of a program that is not installed says so.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "hil/witness/witness.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

namespace fs = std::filesystem;
constexpr double kMicrometre_mm = 1e-3;

bool works(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }
bool isInstalled(const std::string& program) { return works("command -v " + program); }

/// A folder for what the programs write.
class OtherWriters : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("kerfbench-writers-{}", ::getpid());
    fs::create_directories(folder_);
    if (!isInstalled("/usr/bin/python3")) GTEST_SKIP() << "python3 is not installed";
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }
  fs::path written(const std::string& name, const std::string& text) const {
    std::ofstream(file(name), std::ios::binary) << text;
    return file(name);
  }
  /// The fixture, written again by the script.
  fs::path redrawn(const std::string& fixture_name, const std::string& name,
                   const std::string& options) const {
    const std::string command =
        fmt::format("/usr/bin/python3 '{}/tests/hil/dieline/redraw.py' '{}' '{}' {}", KERFBENCH_SOURCE_DIR,
                    fixture(fixture_name).string(), file(name).string(), options);
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return file(name);
  }
  void run(const std::string& command) const {
    EXPECT_EQ(std::system(fmt::format("cd '{}' && {} >log 2>&1", folder_.string(), command).c_str()), 0)
        << command;
  }

 private:
  fs::path folder_;
};

struct Sum {
  double length_mm{};
  Eigen::AlignedBox2d box_mm;
};

template <class Key>
std::map<std::string, Sum> sumsBy(const Dieline& dieline, Key key) {
  std::map<std::string, Sum> sums;
  for (const Entity& entity : dieline.entities) {
    Sum& sum = sums[std::string(key(entity))];
    sum.length_mm += lengthOf(entity.curve);
    for (const double u : stations(entity.curve, 0.05)) sum.box_mm.extend(pointAt(entity.curve, u));
  }
  return sums;
}
std::map<std::string, Sum> processesOfDrawing(const fs::path& path) {
  return sumsBy(readDieline(path, defaultLayerProfile()),
                [](const Entity& e) { return processName(e.process); });
}

void expectSame(const std::map<std::string, Sum>& ours, const std::map<std::string, Sum>& theirs,
                const Eigen::Vector2d& shift_mm, const std::string& what) {
  ASSERT_EQ(ours.size(), theirs.size()) << what;
  for (const auto& [process, sum] : theirs) {
    ASSERT_TRUE(ours.contains(process)) << what << ": " << process;
    const Sum& own = ours.at(process);
    EXPECT_NEAR(own.length_mm, sum.length_mm, kMicrometre_mm) << what << ": " << process;
    EXPECT_NEAR((own.box_mm.min() - sum.box_mm.min() - shift_mm).norm(), 0, kMicrometre_mm) << what;
    EXPECT_NEAR((own.box_mm.max() - sum.box_mm.max() - shift_mm).norm(), 0, kMicrometre_mm) << what;
  }
}

/// The product's second reader (MuPDF) held against ours, colour by colour.
void expectWitnessed(const fs::path& pdf) {
  DrawingOptions all;
  all.layers = {"all", {{"*", Process::kCut}}};
  const witness::Testimony testimony = witness::testimonyOf(
      readDieline(pdf, all), all, witness::witnessBeside(fs::path(KERFBENCH_BINARY_DIR) / "bin"));
  if (testimony.kind == witness::Testimony::Kind::kMissing) GTEST_SKIP() << testimony.sentences.front();
  EXPECT_EQ(testimony.kind, witness::Testimony::Kind::kAgrees) << pdf << ": " << testimony.sentences.front();
}

constexpr const char* kCarton = "tuck-end-carton-window.dxf";

TEST_F(OtherWriters, Cf2IsTheDrawingOfTheDxf) {
  for (const char* name : {kCarton, "button.dxf", "coupon-perforated.dxf"}) {
    const auto dxf = processesOfDrawing(fixture(name));
    for (const char* options : {"", "inch", "sub"})
      expectSame(processesOfDrawing(redrawn(name, "a.cf2", options)), dxf, {0, 0},
                 fmt::format("{} {}", name, options));
  }
}

TEST_F(OtherWriters, PdfIsTheDrawingOfTheDxf) {
  for (const char* name : {kCarton, "button.dxf", "coupon-perforated.dxf"}) {
    const auto dxf = processesOfDrawing(fixture(name));
    for (const char* options : {"", "steps"}) {
      const fs::path pdf = redrawn(name, "a.pdf", fmt::format("1 150 100 {}", options));
      expectSame(processesOfDrawing(pdf), dxf, {150, 100}, fmt::format("{} {}", name, options));
    }
  }
}

TEST_F(OtherWriters, PdfIsReadAsMuPdfReadsIt) { expectWitnessed(redrawn(kCarton, "a.pdf", "1 150 100")); }

TEST_F(OtherWriters, PdfOfCairo) {
  if (!works("/usr/bin/python3 -c 'import cairo'")) GTEST_SKIP() << "python3-cairo is not installed";
  const fs::path pdf = redrawn(kCarton, "a.pdf", "1 150 100 cairo");
  expectWitnessed(pdf);
  // Cairo rounds each coordinate to 1/256 pt.
  const auto dxf = processesOfDrawing(fixture(kCarton));
  const auto ours = processesOfDrawing(pdf);
  for (const auto& [process, sum] : dxf)
    EXPECT_NEAR(ours.at(process).length_mm, sum.length_mm, 0.02) << process;
}

TEST_F(OtherWriters, PdfOfReportLab) {
  if (!works("/usr/bin/python3 -c 'import reportlab'")) GTEST_SKIP() << "python3-reportlab is not installed";
  written("a.py", R"(
from reportlab.pdfgen import canvas
from reportlab.lib.colors import CMYKColorSep, CMYKColor
c = canvas.Canvas('a.pdf', pagesize=(600, 400), pageCompression=1)
c.setStrokeColor(CMYKColorSep(0, 1, 1, 0, spotName='Dieline', density=1))
c.roundRect(20.5, 30.25, 300, 200, 12)
c.saveState()
c.translate(400, 100)
c.rotate(30)
c.circle(0, 0, 33.3)
c.bezier(0, 0, 10, 50, 60, -40, 80, 20)
c.restoreState()
c.setStrokeColor(CMYKColorSep(1, 0, 0, 0, spotName='Crease', density=1))
c.setDash(4, 2)
c.line(20.5, 130, 320.5, 130)
c.setStrokeColor(CMYKColor(0, 0, 0, 1))
c.setDash()
c.beginForm('inner')
c.ellipse(5, 5, 45, 25)
c.endForm()
c.doForm('inner')
c.translate(100, 300)
c.doForm('inner')
c.drawString(50, 20, 'words')
c.save()
)");
  run("/usr/bin/python3 a.py");
  expectWitnessed(file("a.pdf"));
}

TEST_F(OtherWriters, PdfOfGhostscript) {
  if (!isInstalled("gs")) GTEST_SKIP() << "gs (package ghostscript) is not installed";
  written("a.ps", R"(%!PS
<< /PageSize [500 400] >> setpagedevice
[/Separation (Dieline) /DeviceCMYK { 0 exch dup 0 }] setcolorspace 1 setcolor
newpath 50 50 moveto 250 50 lineto 250 150 50 200 50 arcto 4 { pop } repeat 50 200 lineto closepath stroke
gsave 300 200 translate 20 rotate 2 1 scale newpath 0 0 40 0 360 arc closepath stroke grestore
0 0 1 setrgbcolor newpath 60 70 moveto 90 200 130 20 220 120 curveto stroke
1 0 0 setrgbcolor [3 3] 0 setdash newpath 60 300 moveto 400 310 lineto stroke
showpage
)");
  run("gs -q -dNOPAUSE -dBATCH -dSAFER -sDEVICE=pdfwrite -o a.pdf a.ps");
  expectWitnessed(file("a.pdf"));
}

TEST_F(OtherWriters, PdfOfRsvg) {
  if (!isInstalled("rsvg-convert")) GTEST_SKIP() << "rsvg-convert (package librsvg2-bin) is not installed";
  for (const char* name : {"label-60x40.svg", "label-60x40-turned.svg", "label-60x40-paths.svg"}) {
    run(fmt::format("rsvg-convert -f pdf -o a.pdf '{}'", fixture(name).string()));
    expectWitnessed(file("a.pdf"));
    const auto svg = processesOfDrawing(fixture(name));
    const auto pdf = processesOfDrawing(file("a.pdf"));
    ASSERT_EQ(pdf.size(), svg.size());
    // This program writes by cairo, too.
    for (const auto& [process, sum] : svg)
      EXPECT_NEAR(pdf.at(process).length_mm, sum.length_mm, 0.02) << name;
  }
}

TEST_F(OtherWriters, PdfOfInkscape) {
  if (!isInstalled("inkscape")) GTEST_SKIP() << "inkscape is not installed";
  run(fmt::format("inkscape --export-type=pdf --export-filename=a.pdf '{}'",
                  fixture("label-60x40.svg").string()));
  expectWitnessed(file("a.pdf"));
}

TEST_F(OtherWriters, PdfOfLibreOffice) {
  if (!isInstalled("soffice")) GTEST_SKIP() << "soffice (package libreoffice-draw) is not installed";
  fs::copy_file(fixture("label-60x40.svg"), file("a.svg"));
  run("HOME=. soffice --headless --convert-to pdf a.svg");
  expectWitnessed(file("a.pdf"));
}

/// Packed, unpacked, with objects in streams, linearised: the same drawing to the last bit.
TEST_F(OtherWriters, PdfWrittenAgainByQpdfIsTheSame) {
  if (!isInstalled("qpdf")) GTEST_SKIP() << "qpdf is not installed";
  redrawn(kCarton, "a.pdf", "1 150 100 steps");
  const Dieline whole = readDieline(file("a.pdf"), defaultLayerProfile());
  for (const char* options :
       {"--qdf", "--object-streams=generate", "--linearize", "--newline-before-endstream",
        "--object-streams=generate --recompress-flate --compression-level=9"}) {
    run(fmt::format("qpdf {} a.pdf b.pdf", options));
    const Dieline again = readDieline(file("b.pdf"), defaultLayerProfile());
    ASSERT_EQ(again.entities.size(), whole.entities.size()) << options;
    for (std::size_t i = 0; i < whole.entities.size(); ++i) {
      EXPECT_EQ(apart(again.entities[i].curve, whole.entities[i].curve), 0.0);
      EXPECT_EQ(again.entities[i].layer, whole.entities[i].layer);
    }
  }
  run("qpdf --encrypt user owner 256 -- a.pdf b.pdf");
  EXPECT_THROW(readDieline(file("b.pdf"), defaultLayerProfile()), DielineError);
  run("qpdf --encrypt '' owner 256 -- a.pdf b.pdf");
  EXPECT_THROW(readDieline(file("b.pdf"), defaultLayerProfile()), DielineError);
}

TEST_F(OtherWriters, PdfOfPoppler) {
  if (!isInstalled("pdftocairo")) GTEST_SKIP() << "pdftocairo (package poppler-utils) is not installed";
  redrawn(kCarton, "a.pdf", "1 150 100");
  run("pdftocairo -pdf a.pdf b.pdf");
  expectWitnessed(file("b.pdf"));
}

}  // namespace
}  // namespace kerfbench::dieline
