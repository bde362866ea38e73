// SPDX-License-Identifier: Apache-2.0
#include "hil/base/digest.h"

#include <gtest/gtest.h>

#include <system_error>

namespace kerfbench::hil {
namespace {

TEST(Digest, GivesTheStandardsOwnExamples) {  // FIPS 180-4
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Digest, RefusesAFileThatIsNotThere) { EXPECT_THROW(sha256File("/nonexistent/x"), std::system_error); }

}  // namespace
}  // namespace kerfbench::hil
