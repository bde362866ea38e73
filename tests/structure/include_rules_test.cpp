// SPDX-License-Identifier: Apache-2.0
// The include graph is the design: rules about which room may use which. A new rule belongs here, not in a
// review.
#include <gtest/gtest.h>

#include "tests/structure/source_text.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using kerfbench::test::sourceRoot;

struct Include {
  std::string file;    // Path from the root of the project.
  std::string target;  // Text between the quotes or brackets.
};

std::vector<fs::path> sources() {
  std::vector<fs::path> found;
  for (const char* top : {"twin", "hil", "firmware_under_test", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      const auto extension = entry.path().extension();
      if (extension == ".cpp" || extension == ".h" || extension == ".c") found.push_back(entry.path());
    }
  }
  std::ranges::sort(found);
  return found;
}

std::vector<Include> readIncludes() {
  static const std::regex kPattern(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  std::vector<Include> found;
  for (const fs::path& path : sources()) {
    std::ifstream file(path);
    std::string line;
    while (std::getline(file, line)) {
      std::smatch match;
      if (std::regex_search(line, match, kPattern)) {
        found.push_back({fs::relative(path, sourceRoot()).string(), match[1].str()});
      }
    }
  }
  return found;
}

/// The whole tree is read once for all rules.
const std::vector<Include>& includes() {
  static const std::vector<Include> kIncludes = readIncludes();
  return kIncludes;
}

bool in(const std::string& path, const std::string& folder) { return path.starts_with(folder + "/"); }

std::string offenders(const std::function<bool(const Include&)>& is_offence) {
  std::string text;
  for (const Include& include : includes()) {
    if (is_offence(include)) text += include.file + " includes " + include.target + "\n";
  }
  return text;
}

TEST(IncludeRules, AreCheckedOnTheRealTree) { EXPECT_GT(includes().size(), 200U); }

TEST(IncludeRules, TheTwinKnowsNothingOfTheBenchOrTheFirmware) {
  EXPECT_EQ(offenders([](const Include& i) {
              return in(i.file, "twin") && (in(i.target, "hil") || in(i.target, "firmware_under_test"));
            }),
            "");
}

TEST(IncludeRules, VisionAndInspectionKnowOnlyTheBaseOfTheTwin) {
  EXPECT_EQ(offenders([](const Include& i) {
              return (in(i.file, "hil/vision") || in(i.file, "hil/inspect") || in(i.file, "hil/calibrate") ||
                      in(i.file, "hil/dieline")) &&
                     in(i.target, "twin") && !in(i.target, "twin/base");
            }),
            "");
}

TEST(IncludeRules, VisionAndInspectionDoNotReachTheTwinByWayOfAnotherFolder) {
  EXPECT_EQ(offenders([](const Include& i) {
              return (in(i.file, "hil/vision") || in(i.file, "hil/inspect") || in(i.file, "hil/calibrate")) &&
                     (in(i.target, "firmware_under_test") || in(i.target, "hil/app") ||
                      in(i.target, "hil/instrument") || in(i.target, "hil/source") ||
                      in(i.target, "hil/scene") || in(i.target, "hil/gauge") ||
                      in(i.target, "hil/camera/twin"));
            }),
            "");
}

// The head's calibration is compared with the twin's optics, and its tables are run by the planner: code
// shared with either would cancel its own error.
TEST(IncludeRules, TheHeadsCalibrationHasOpticsOfItsOwn) {
  EXPECT_EQ(offenders([](const Include& i) {
              return in(i.file, "hil/calibrate/head") &&
                     ((in(i.target, "twin") && !in(i.target, "twin/base")) ||
                      in(i.target, "firmware_under_test") ||
                      (in(i.target, "hil") && !in(i.target, "hil/calibrate/head") &&
                       !in(i.target, "hil/calibrate/tables") && !in(i.target, "hil/base")));
            }),
            "");
}

// What a diagnosis knows comes in one struct, from pictures, pins, words, program and data sheets: a cause
// that it looked up in the model would be right at all times and worth nothing.
TEST(IncludeRules, TheDiagnosisKnowsNothingOfTheModel) {
  EXPECT_EQ(offenders([](const Include& i) {
              const bool is_evidence = i.file.starts_with("hil/judge/diagnosis_evidence") ||
                                       i.file.starts_with("hil/judge/asked_path") ||
                                       i.file.starts_with("hil/judge/timed_cuts") ||
                                       i.file.starts_with("hil/judge/gate_readings");
              return (in(i.file, "hil/diagnose") && in(i.target, "twin") && !in(i.target, "twin/base")) ||
                     (in(i.file, "hil/diagnose") && in(i.target, "firmware_under_test")) ||
                     (is_evidence &&
                      (i.target.starts_with("twin/cutter") || i.target == "hil/run/model_machine.h"));
            }),
            "");
}

// Gauge contains the model's truth, to measure the measurement's error by it. Code that judges a run may not
// use it.
TEST(IncludeRules, OnlyItsCommandAsksTheGauge) {
  EXPECT_EQ(offenders([](const Include& i) {
              return in(i.target, "hil/gauge") && !in(i.file, "hil/gauge") &&
                     i.file != "hil/instrument/gauge_command.h" &&
                     i.file != "hil/instrument/gauge_command.cpp" && !in(i.file, "tests/hil/gauge");
            }),
            "");
}

TEST(IncludeRules, TheFirmwareAndItsPlannerKnowNothingOfTheTwin) {
  EXPECT_EQ(
      offenders([](const Include& i) { return in(i.file, "firmware_under_test") && in(i.target, "twin"); }),
      "");
}

// Text, numbers, charts, whole files and strict YAML judge nothing.
TEST(IncludeRules, OfTheBenchThePlannerUsesTheDielineAndNothingThatJudges) {
  EXPECT_EQ(
      offenders([](const Include& i) {
        const std::set<std::string> judges_nothing{
            "hil/base/atomic_file.h",  "hil/base/chart.h",        "hil/base/console.h",
            "hil/base/file_content.h", "hil/base/input_file.h",   "hil/base/number_from.h",
            "hil/base/text.h",         "hil/base/installation.h", "hil/base/terminal.h"};
        return in(i.file, "firmware_under_test") && in(i.target, "hil") && !in(i.target, "hil/dieline") &&
               i.target != "hil/source/pin_stream.h" &&
               !(in(i.file, "firmware_under_test/planner") && judges_nothing.contains(i.target)) &&
               !(in(i.file, "firmware_under_test/planner/kerfplan") &&
                 (in(i.target, "hil/command_line") || i.target == "hil/base/version.h")) &&
               !(in(i.file, "firmware_under_test/planner/power") && i.target == "hil/base/yaml_reader.h");
      }),
      "");
}

struct Library {
  const char* name;
  const char* header;  // A regular expression of its includes.
  std::vector<std::string> folders;
};

bool inGplChild(const std::string& file) {
  return in(file, "hil/source/avr_child") || in(file, "hil/source/analyser/sigrok_child");
}

/// What the children share is under both licences, for whatever their libraries ask.
bool inChildrensLibrary(const std::string& file) {
  return in(file, "hil/source/emulator") || file == "hil/source/pin_stream.h";
}

// A child is a program of its own, so that its library's licence does not become the bench's.
TEST(IncludeRules, NothingOfAGplChildIsPartOfTheBench) {
  EXPECT_EQ(offenders([](const Include& i) {
              return inGplChild(i.target) && !inGplChild(i.file) && !in(i.file, "tests");
            }),
            "");
  EXPECT_EQ(offenders([](const Include& i) {
              return inChildrensLibrary(i.file) && i.target.starts_with("hil/") &&
                     !inChildrensLibrary(i.target);
            }),
            "");
}

// An emulator of our own runs a firmware that may do anything: its faults stay in its process.
TEST(IncludeRules, NothingOfAnEmulatorsCoreIsPartOfTheBench) {
  EXPECT_EQ(offenders([](const Include& i) {
              const auto isAcross = [&](const char* core) {
                return in(i.target, core) && !in(i.file, core) && !in(i.file, "tests");
              };
              return isAcross("hil/source/mcs51_child") || isAcross("hil/source/cortex_m_child");
            }),
            "");
}

TEST(IncludeRules, ALibraryAppearsOnlyInTheSourceFilesOfTheFoldersThatNeedIt) {
  const std::vector<Library> libraries{
      {"Bullet", "^(Bullet|Linear[A-Z]|bt[A-Z]).*", {"twin/machine"}},
      {"OpenCV",
       "^opencv2/.*",
       {"hil/camera/v4l2", "hil/vision", "hil/calibrate", "hil/drawing", "hil/scene", "twin/camera"}},
      {"libpng", "^png\\.h$", {"hil/base"}},
      {"libjpeg", "^jpeglib\\.h$", {"hil/camera"}},
      {"libgpiod", "^gpiod\\.h(pp)?$", {"hil/source/gpio"}},
      {"the kernel's GPIO interface", "^linux/gpio\\.h$", {"hil/source/gpio"}},
      {"the kernel's terminals", "^asm/termbits\\.h$", {"hil/source/serial"}},
      {"yaml-cpp", "^yaml-cpp/.*", {"hil/base", "hil/desk"}},
      {"QPDF", "^qpdf/.*", {"hil/dieline"}},
      {"pugixml", "^pugixml.*", {"hil/dieline", "hil/report", "hil/suite"}},
      {"OpenSSL", "^openssl/.*", {"hil/base"}},
      {"V4L2", "^linux/(videodev2|v4l2-.*)\\.h$", {"hil/camera/v4l2"}},
      {"simavr", "^(simavr/|sim_|avr_).*", {"hil/source/avr_child"}},
      {"Unicorn", "^unicorn/.*", {}},  // Tests only.
      {"libsigrok", "^libsigrok/.*", {"hil/source/analyser/sigrok_child"}},
      {"zstd", "^zstd\\.h$", {"hil/trace"}},
      {"zlib", "^zlib\\.h$", {"hil/trace"}},
      {"libzip", "^zip\\.h$", {"hil/source/analyser"}},
      {"cpp-httplib", "^httplib\\.h$", {"hil/serve"}},
  };
  for (const Library& library : libraries) {
    const std::regex pattern(library.header);
    EXPECT_EQ(offenders([&](const Include& i) {
                if (in(i.file, "tests") || !std::regex_match(i.target, pattern)) return false;
                // A child as a whole is the adapter to its library, its own headers included.
                const bool is_source =
                    i.file.ends_with(".cpp") || i.file.ends_with(".c") || inGplChild(i.file);
                return !is_source ||
                       std::ranges::none_of(library.folders, [&](const auto& f) { return in(i.file, f); });
              }),
              "")
        << library.name;
  }
}

TEST(IncludeRules, OnlyTheChildrenWhoseLibrariesAskForItAreUnderTheGpl) {
  for (const fs::path& path : sources()) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    const std::string name = fs::relative(path, sourceRoot()).string();
    const bool gpl_allowed =
        inGplChild(name) || name.starts_with("tests/firmware_under_test/controller/avr_") ||
        in(name, "tests/hil/source/avr_core") || name == "tests/benchmarks/simavr_runner.cpp" ||
        in(name, "tests/hil/source/analyser/sigrok_child");
    const bool apache = line.find("SPDX-License-Identifier: Apache-2.0") != std::string::npos;
    const bool gpl = line.find("SPDX-License-Identifier: GPL-3.0-or-later") != std::string::npos;
    const bool gpl2 = line.find("SPDX-License-Identifier: GPL-2.0-or-later") != std::string::npos;
    const bool either =
        line.find("SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later") != std::string::npos;
    EXPECT_EQ(either, inChildrensLibrary(name)) << name << ": " << line;
    EXPECT_EQ(gpl2, in(name, "tests/hil/source/cortex_m/oracle")) << name << ": " << line;
    EXPECT_TRUE(apache || gpl2 || (gpl && gpl_allowed)) << name << ": " << line;
  }
}

/// A function that a header declares without KERFBENCH_WIDE is compiled by clang++ 14 as if it were not
/// there.
TEST(IncludeRules, WideFunctionsAreOfOneSource) {
  std::size_t seen = 0;
  for (const fs::path& path : sources()) {
    const std::string name = fs::relative(path, sourceRoot()).string();
    if (path.extension() != ".cpp" || in(name, "tests/structure")) continue;
    const std::string text = textOf(path);
    for (std::size_t at = text.find("KERFBENCH_WIDE "); at != std::string::npos;
         at = text.find("KERFBENCH_WIDE ", at + 1)) {
      ++seen;
      const std::size_t opened = text.rfind("\nnamespace {\n", at);
      const std::size_t closed = text.rfind("\n}  // namespace\n", at);
      EXPECT_TRUE(opened != std::string::npos && (closed == std::string::npos || closed < opened))
          << name << ": " << text.substr(at, text.find('(', at) - at);
    }
  }
  EXPECT_GT(seen, 20U);
}

}  // namespace
