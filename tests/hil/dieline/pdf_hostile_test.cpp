// SPDX-License-Identifier: Apache-2.0
// PDF files that are broken by accident or on purpose: refused with one sentence, in little time and memory.
#include <zlib.h>

#include <cstdio>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"
#include "tests/hil/dieline/pdf_writer.h"
#include "tests/hil/dieline/reading_child.h"

#if defined(__SANITIZE_ADDRESS__)
#define KERFBENCH_MEMORY_IS_WATCHED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define KERFBENCH_MEMORY_IS_WATCHED
#endif
#endif

namespace kerfbench::dieline {
namespace {

using testing::HasSubstr;

std::string packed(const std::string& data) {
  uLongf size = compressBound(data.size());
  std::string text(size, '\0');
  compress2(reinterpret_cast<Bytef*>(text.data()), &size, reinterpret_cast<const Bytef*>(data.data()),
            data.size(), 1);
  text.resize(size);
  return text;
}
std::string repeated(const std::string& part, std::size_t count) {
  std::string text;
  text.reserve(part.size() * count);
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

/// One page whose content is this stream.
std::string withContent(const std::string& stream) {
  return pdfOf(
      {"<< /Pages 2 0 R >>", "<< /Kids [3 0 R] >>", "<< /MediaBox [0 0 200 200] /Contents 4 0 R >>", stream});
}
std::string withPacked(const std::string& content) {
  return withContent(pdfStream(packed(content), "/Filter /FlateDecode"));
}
/// A page with more keys.
std::string withKeys(const std::string& keys) {
  return pdfOf({"<< /Pages 2 0 R >>", "<< /Kids [3 0 R] >>", "<< /MediaBox [0 0 200 200] " + keys + " >>"});
}
/// Each of `depth` forms draws the next ten times; the last draws `innermost`.
std::string withForms(int depth, int copies, const std::string& innermost) {
  PdfPage page{.resources = "/XObject << /F 5 0 R >>"};
  for (int i = 0; i < depth; ++i) {
    page.objects.push_back(pdfForm(repeated("/F Do ", static_cast<std::size_t>(copies)),
                                   "/XObject << /F " + std::to_string(i + 6) + " 0 R >>"));
  }
  page.objects.push_back(pdfForm(innermost));
  return pdfPage("/F Do", page);
}

struct Hostile {
  std::string name;
  std::string file;
  std::string sentence;
};

/// What takes much of what there is.
std::vector<Hostile> greedyFiles() {
  const std::string much = "this is not how a drawing is written";
  const std::string twice = packed(packed(std::string(70'000'000, '\0')));
  return {
      {"packed blanks", withPacked(std::string(68'000'000, ' ')), much},
      {"packed twice", withContent(pdfStream(twice, "/Filter [/FlateDecode /FlateDecode]")), much},
      {"run lengths", withContent(pdfStream("\x81 ", "/Filter /RunLengthDecode")), "cannot be unpacked"},
      {"LZW", withContent(pdfStream("\x80\x0b", "/Filter /LZWDecode")), "cannot be unpacked (/LZWDecode)"},
      {"states", withPacked(repeated("q ", 1'000'000)), "q is nested deeper than 512"},
      {"operators", withPacked(repeated("q Q ", 3'100'000)), "more than 6000000 operators"},
      {"words", withPacked("[" + repeated("1 ", 16'100'000) + "] TJ"), "more than 16000000 words"},
      {"operands", withPacked(repeated("1 ", 1'000'000)), "more than 64 operands"},
      {"arrays", withPacked(repeated("[", 1'000'000)), "nested deeper than 512"},
      {"sections", withPacked(repeated("/A BMC ", 1'000'000)), "nested deeper than 512"},
      {"a long path", withPacked("0 0 m " + repeated("9 9 l ", 1'000'100)), "more than 1000000 pieces"},
      {"many lines", withPacked("1 0 0 RG " + repeated("0 0 m 9 9 l S ", 1'000'100)),
       "more than 1000000 entities"},
      {"clips", withPacked(repeated("0 0 m 99 0 l 50 99 l W n ", 1'000)), "clip paths are too intricate"},
      {"an intricate clip",
       withPacked("0 0 m " + repeated("1 1 2 2 3 3 c ", 19'000) + "W n " + repeated("5 5 m 9 9 l S ", 1000)),
       "clip paths are too intricate"},
      {"empty forms", withForms(14, 10, ""), "draws forms more than 200000 times"},
      {"forms in forms", withForms(40, 1, ""), "nested deeper than 16: does it draw itself?"},
      {"one content again and again",
       pdfOf({"<< /Pages 2 0 R >>", "<< /Kids [3 0 R] >>",
              "<< /MediaBox [0 0 9 9] /Contents [" + repeated("4 0 R ", 100'000) + "] >>",
              pdfStream(packed(repeated("n ", 100'000)), "/Filter /FlateDecode")}),
       much},
      {"a large array", withKeys("/X [" + repeated("0 ", 4'000'000) + "]"), much},
      {"an array of arrays", withKeys("/X [" + repeated("[0]", 1'000'000) + "]"), much},
      {"nested arrays", withKeys("/X " + repeated("[", 300'000)), "has no page"},
      {"nested dictionaries", withKeys("/X " + repeated("<</A", 100'000)), "has no page"},
      {"many pages",
       pdfOf({"<< /Pages 2 0 R >>", "<< /Kids [" + repeated("3 0 R ", 300'000) + "] >>", "<< /Kids [] >>"}),
       much},
  };
}

/// A table of objects as a stream, of so many bytes.
std::string withPackedTable(std::size_t bytes) {
  const std::string head = "%PDF-1.6\n1 0 obj\n<< /Pages 2 0 R >>\nendobj\n";
  return head + "3 0 obj\n" +
         pdfStream(packed(std::string(bytes, '\0')), "/Type /XRef /Size " + std::to_string(bytes / 3) +
                                                         " /W [1 1 1] /Root 1 0 R /Filter /FlateDecode") +
         "\nendobj\nstartxref\n" + std::to_string(head.size()) + "\n%%EOF\n";
}

TEST(HostilePdf, GreedyFilesAreRefusedWithOneSentence) {
  for (const Hostile& hostile : greedyFiles()) {
    const TempFile file(".pdf", hostile.file);
    expectRefusedInTime(file.path(), hostile.name, hostile.sentence);
  }
  EXPECT_THAT(faultsOf(".pdf", withPackedTable(3'000'000)),
              HasSubstr("this is not how a drawing is written"));
}

std::size_t peakOfMemory_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoul(line.substr(6)) / 1024;
  }
  return 1U << 20U;
}

TEST(HostilePdfDeathTest, GreedyFilesTakeLittleMemory) {
#ifdef KERFBENCH_MEMORY_IS_WATCHED
  GTEST_SKIP() << "the sanitizer's own memory counts";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  // The files are on disk: making them takes more memory than reading them may.
  std::vector<std::unique_ptr<TempFile>> files;
  for (const Hostile& hostile : greedyFiles())
    files.push_back(std::make_unique<TempFile>(".pdf", hostile.file));
  files.push_back(std::make_unique<TempFile>(".pdf", withPackedTable(1'000'000)));
  const auto read = [&] {
    const std::size_t before_mib = peakOfMemory_mib();
    // Writing 5 resets what is the most so far.
    std::ofstream("/proc/self/clear_refs") << 5;
    for (const auto& file : files) {
      try {
        (void)readDieline(file->path(), defaultLayerProfile());
      } catch (const DielineError&) {
      }
    }
    std::fprintf(stderr, "peak of %zu MiB, %zu before\n", peakOfMemory_mib(), before_mib);
    std::_Exit(peakOfMemory_mib() <= 256 ? 0 : 1);
  };
  EXPECT_EXIT(read(), testing::ExitedWithCode(0), "peak of");
}

TEST(HostilePdf, IsToldWhatIsWrong) {
  const auto faults = [](const std::string& content) { return faultsOf(".pdf", pdfPage(content)); };
  EXPECT_THAT(faults("1e308 0 m"), HasSubstr("has the operator '1e308', which there is not"));
  EXPECT_THAT(faults("nan 0 m"), HasSubstr("has the operator 'nan'"));
  EXPECT_THAT(faults("1" + std::string(308, '0') + " 0 m"), HasSubstr("with one out of range"));
  EXPECT_THAT(faults("1" + std::string(400, '0') + " 0 m"), HasSubstr("with one out of range"));
  EXPECT_THAT(faults(repeated("99999999 0 0 99999999 0 0 cm ", 50) + "1 1 m"),
              HasSubstr("wrong units or scale?"));
  EXPECT_THAT(faults("1 m"), HasSubstr("has m without the numbers that it needs"));
  EXPECT_THAT(faults("(a) 1 m"), HasSubstr("has m without the numbers"));
  EXPECT_THAT(faults("1 1 l S"), HasSubstr("begins without a point"));
  EXPECT_THAT(faults("(a"), HasSubstr("broken at '('"));
  EXPECT_THAT(faults("<61"), HasSubstr("broken at '<'"));
  EXPECT_THAT(faults("]"), HasSubstr("closes an array that is not open"));
  EXPECT_THAT(faults("[1"), HasSubstr("ends within an array"));
  EXPECT_THAT(faults("ID \1\2"), HasSubstr("an image within the drawing of its page has no end"));
  EXPECT_THAT(faults("/X Do"), HasSubstr("draws 'X', which is not in the file"));
  EXPECT_THAT(faults("1 RG"), HasSubstr("has RG without"));
  EXPECT_THAT(
      faultsOf(".pdf", pdfPage("/F Do", {.resources = "/XObject << /F 5 0 R >>",
                                         .objects = {pdfForm("/F Do /F Do", "/XObject << /F 5 0 R >>")}})),
      HasSubstr("form 'F' is nested deeper than 16: does it draw itself?"));
  EXPECT_THAT(faultsOf(".pdf", "%PDF"), HasSubstr("is no sound PDF (can't find startxref)"));
  EXPECT_THAT(faultsOf(".pdf", std::string(1000, '\0')), HasSubstr("is no sound PDF"));
  const std::string sound = pdfPage("1 0 0 RG 0 0 m 9 9 l S");
  EXPECT_THAT(faultsOf(".pdf", sound.substr(0, sound.size() / 2)),
              HasSubstr("mend it with \"qpdf IN.pdf OUT.pdf\""));
  // What the table of objects says must be true: a reader that mends it may find what was deleted.
  std::string moved = sound;
  moved.insert(moved.find("3 0 obj"), "%shift\n");
  EXPECT_THAT(faultsOf(".pdf", moved), HasSubstr("is no sound PDF"));
  EXPECT_THAT(faultsOf(".pdf", pdfOf({"<< /Pages 2 0 R >>"},
                                     "/Encrypt << /Filter /Standard /V 1 /R 2 /O (x) /U (y) /P "
                                     "-4 >> /ID [(a) (b)]")),
              HasSubstr("is encrypted; save it without a password"));
}

/// Cuts, changes and doubles parts of sound files; each must be read or refused with its path.
TEST(HostilePdf, MutatedFilesAreReadOrRefused) {
  std::mt19937 random(11);
  const auto upTo = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const std::vector<std::string> junk{"-1",     "99999999999999999999",
                                      "1e308",  "nan",
                                      "/F Do ", "[",
                                      "<<",     "0 0 R",
                                      "3 0 R",  "endobj",
                                      "\xff",   "q ",
                                      "W n "};
  const PdfPage page{
      .resources =
          "/XObject << /F 5 0 R >> /ColorSpace << /C [/Separation /Cut /DeviceRGB 9 0 R] >> "
          "/Properties << /A 6 0 R >>",
      .catalogue = "/OCProperties << /OCGs [6 0 R] /D << /OFF [] >> >>",
      .objects = {pdfForm("1 0 0 RG 10 10 m 20 20 30 30 40 10 c s"), "<< /Type /OCG /Name (Cut) >>"}};
  const std::string whole = pdfPage(
      "/OC /A BDC q 1 0 0 1 5 5 cm /C CS 1 SCN 0 0 50 50 re S /F Do Q EMC 0 0 99 99 re W n 5 5 m 9 9 l S",
      page);
  ASSERT_EQ(readText(".pdf", whole).entities.size(), 7U);
  int refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string text = whole;
    for (std::size_t n = upTo(3) + 1; n > 0; --n) {
      const std::size_t at = upTo(text.size());
      const std::size_t length = std::min(upTo(30), text.size() - at);
      switch (upTo(4)) {
        case 0:
          text.erase(at, length);
          break;
        case 1:
          text.replace(at, length,
                       std::string(length, ' ').replace(0, 0, junk[upTo(junk.size())]).substr(0, length));
          break;
        case 2:
          text[at] = static_cast<char>(upTo(256));
          break;
        default:
          text.insert(at, junk[upTo(junk.size())]);
      }
    }
    const std::string faults = faultsOf(".pdf", text);
    refused += faults.empty() ? 0 : 1;
    if (!faults.empty()) EXPECT_THAT(faults, HasSubstr("kerfbench-dieline-"));
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 1500);
}

}  // namespace
}  // namespace kerfbench::dieline
