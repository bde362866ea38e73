// SPDX-License-Identifier: Apache-2.0
// Each function that reads what comes from outside has a target, or stands here with the reason why not.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {
namespace {

namespace fs = std::filesystem;

/// Headers that declare a reader of a file without a target of their own.
const std::map<std::string, std::string>& unfuzzed() {
  static const std::string kSettings = "settings, by the reader of YAML that scenario and machine go through";
  static const std::string kRecord =
      "a record of the bench, in JSON: parsed by nlohmann::json, whose own fuzzing is larger";
  static const std::map<std::string, std::string> kWhy{
      {"hil/base/input_file.h", "opens for all of them"},
      {"hil/camera/picture_file.h", "the target picture decodes its bytes"},
      {"hil/campaign/campaign_file.h", kSettings},
      {"hil/compare/run_figures.h", kRecord},
      {"hil/fold/fold_machine.h", kSettings},
      {"hil/fold/fold_scenario.h", kSettings},
      {"hil/head_service/check_history.h", kRecord},
      {"hil/head_service/head_record.h", kRecord},
      {"hil/head_service/head_setup.h", kSettings},
      {"hil/head_service/measured_sheet.h", kSettings},
      {"hil/head_service/service_steps.h", kRecord},
      {"hil/history/run_history.h", kRecord},
      {"hil/live/recording_file.h", "chooses between recording_vcd and recording_sr"},
      {"hil/machine_file/drive_catalogue.h", kSettings},
      {"hil/machine_file/machine_text.h", "the target machine reads the same from its file"},
      {"hil/scenario/case.h", "scenario, machine and drawing have their targets"},
      {"hil/source/gpio/chips.h", "a device of this computer"},
      {"hil/suite/plan.h", kSettings},
      {"hil/suite/run_verdict.h", kRecord},
      {"hil/suite/suite_record.h", kRecord},
      {"firmware_under_test/planner/power/library.h", kSettings},
  };
  return kWhy;
}

std::string textOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool takesAPath(const std::string& header) {
  static const std::regex kReader(R"((^|\n)[^\n/]*\bread\w*\(\s*const\s+(std::filesystem|fs)::path\s*&)");
  return std::regex_search(header, kReader);
}

TEST(FuzzTargets, AreThereForEveryReader) {
  const fs::path root = KERFBENCH_SOURCE_DIR;
  std::set<std::string> known;
  for (const Target& target : targets()) {
    EXPECT_TRUE(fs::exists(root / target.header)) << target.header;
    known.emplace(target.header);
  }
  std::set<std::string> readers;
  for (const char* top : {"hil", "firmware_under_test"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      if (entry.path().extension() != ".h" || !takesAPath(textOf(entry.path()))) continue;
      readers.insert(fs::relative(entry.path(), root).generic_string());
    }
  }
  for (const std::string& reader : readers)
    EXPECT_TRUE(known.contains(reader) || unfuzzed().contains(reader))
        << reader << " declares a reader: give it a target in tests/fuzz/targets.cpp";
  for (const auto& [header, why] : unfuzzed()) {
    EXPECT_TRUE(readers.contains(header)) << header << " declares no reader any more";
    EXPECT_FALSE(known.contains(header)) << header << " has a target";
    EXPECT_FALSE(why.empty()) << header;
  }
}

}  // namespace
}  // namespace kerfbench::fuzz
