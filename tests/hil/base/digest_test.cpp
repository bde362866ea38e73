// SPDX-License-Identifier: Apache-2.0
#include "hil/base/digest.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <system_error>

namespace kerfbench::base {
namespace {

TEST(Digest, GivesTheStandardsOwnExamples) {  // Example of FIPS 180-4.
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

// The values are those of xxh128sum.
TEST(Digest, ChecksumIsXxh3OfThePublishedCases) {
  EXPECT_EQ(checksum({}), "99aa06d3014798d86001c324468d497f");
  const std::array<std::uint8_t, 3> abc{'a', 'b', 'c'};
  EXPECT_EQ(checksum(abc), "06b05ab6733a618578af5f94892f3950");
}

TEST(Digest, RefusesAFileThatIsNotThere) { EXPECT_THROW(sha256File("/nonexistent/x"), std::system_error); }

}  // namespace
}  // namespace kerfbench::base
