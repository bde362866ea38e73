// SPDX-License-Identifier: Apache-2.0
// Files that broke a reader once, in findings/TARGET, and sound ones: each goes through the reader again.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/sound_inputs.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {
namespace {

namespace fs = std::filesystem;

const fs::path& findings() {
  static const fs::path kFolder = fs::path(KERFBENCH_SOURCE_DIR) / "tests/fuzz/findings";
  return kFolder;
}

Bytes bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// What broke a reader is taken or refused now: another exception, or a signal, ends this test.
TEST(FuzzFindings, AreTakenOrRefused) {
  for (const Target& target : targets()) {
    const fs::path folder = findings() / target.name;
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      SCOPED_TRACE(entry.path().string());
      EXPECT_NO_THROW((void)target.read(bytesOf(contentOf(entry.path()))));
    }
  }
}

TEST(FuzzFindings, BelongToATarget) {
  for (const auto& entry : fs::directory_iterator(findings())) {
    if (!entry.is_directory()) continue;
    EXPECT_TRUE(std::ranges::any_of(targets(), [&](const Target& target) {
      return target.name == entry.path().filename().string();
    })) << entry.path();
  }
}

// A target that takes nothing would look at the first line of its reader for ever.
TEST(FuzzTargets, TakeWhatIsSound) {
  for (const auto& [name, text] : soundInputs()) {
    const auto target = std::ranges::find(targets(), name, &Target::name);
    ASSERT_NE(target, targets().end()) << name;
    EXPECT_TRUE(target->read(bytesOf(text))) << name;
  }
}

// Empty and short inputs, and bytes of no meaning: the first that a fuzzer tries.
TEST(FuzzTargets, RefuseWhatHasNoMeaning) {
  for (const Target& target : targets()) {
    SCOPED_TRACE(target.name);
    for (const std::string& text : {std::string(), std::string("\0", 1), std::string(300, '\xff')})
      EXPECT_NO_THROW((void)target.read(bytesOf(text)));
  }
}

}  // namespace
}  // namespace kerfbench::fuzz
