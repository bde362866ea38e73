// SPDX-License-Identifier: Apache-2.0
#include "hil/app/other_program.h"

#include <gtest/gtest.h>

#include <array>
#include <system_error>
#include <tuple>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::app {
namespace {

TEST(InstrumentProgram, ThatIsNotBuiltIsToldWithTheCommandThatBuildsIt) {
  const base::TempFolder folder;
  std::array<char*, 1> no_words{};
  try {
    becomeProgram(folder.path() / "kerfbench-instrument", "gauge", no_words.data());
  } catch (const ProgramMissing& e) {
    EXPECT_STREQ(e.what(),
                 "kerfbench gauge is in kerfbench-instrument, which is not built: ./bench gauge builds it");
  }
}

TEST(InstrumentProgram, ThatCannotBeStartedIsNotTakenForMissing) {
  const base::TempFolder folder;
  std::ignore = folder.write("kerfbench-instrument", "no program");
  std::array<char*, 1> no_words{};
  EXPECT_THROW(becomeProgram(folder.path() / "kerfbench-instrument", "gauge", no_words.data()),
               std::system_error);
}

}  // namespace
}  // namespace kerfbench::app
