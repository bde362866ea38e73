// SPDX-License-Identifier: Apache-2.0
#include "hil/app/ci_variable.h"

#include <gtest/gtest.h>

namespace kerfbench::app {
namespace {

TEST(CiVariable, ThatIsSetMeansCi) {
  for (const char* value : {"true", "1", "woodpecker", "False?"}) EXPECT_TRUE(isCi(value)) << value;
}

TEST(CiVariable, ThatIsMissingEmptyOrFalseMeansNone) {
  EXPECT_FALSE(isCi(nullptr));
  EXPECT_FALSE(isCi(""));
  EXPECT_FALSE(isCi("false"));
}

}  // namespace
}  // namespace kerfbench::app
