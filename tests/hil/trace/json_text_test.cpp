// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/json_text.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "twin/base/random.h"

namespace kerfbench::trace {
namespace {

std::string numberText(double value, int decimals) {
  std::string text;
  appendNumber(text, value, decimals);
  return text;
}

std::string quotedText(std::string_view value) {
  std::string text;
  appendQuoted(text, value);
  return text;
}

TEST(JsonText, RoundsToItsDecimalsAndLeavesOutZeros) {
  EXPECT_EQ(numberText(0.0, 4), "0");
  EXPECT_EQ(numberText(-0.00001, 4), "0");
  EXPECT_EQ(numberText(1.5, 4), "1.5");
  EXPECT_EQ(numberText(-12.34567, 4), "-12.3457");
  EXPECT_EQ(numberText(0.0005, 9), "0.0005");
  EXPECT_EQ(numberText(100.0, 0), "100");
  EXPECT_EQ(numberText(0.99996, 4), "1");
  EXPECT_EQ(numberText(std::numeric_limits<double>::quiet_NaN(), 4), "null");
  EXPECT_EQ(numberText(std::numeric_limits<double>::infinity(), 4), "null");
}

TEST(JsonText, ANumberIsReadBackWithinHalfOfItsLastDigit) {
  const CounterRandom random(3, 0);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const double value =
        (random.uniform(2 * i) - 0.5) * std::pow(10.0, 12.0 * random.uniform(2 * i + 1) - 6.0);
    for (const int decimals : {0, 3, 4, 9}) {
      const double read = nlohmann::json::parse(numberText(value, decimals)).get<double>();
      EXPECT_NEAR(read, value, 0.5 * std::pow(10.0, -decimals) + 1e-15 * std::abs(value));
    }
  }
  EXPECT_EQ(nlohmann::json::parse(numberText(1e300, 9)).get<double>(), 1e300);
}

TEST(JsonText, AnyBytesBecomeATextThatIsUtf8) {
  EXPECT_EQ(quotedText("a\"b\\c\n"), "\"a\\\"b\\\\c\\u000a\"");
  EXPECT_EQ(quotedText("µm €"), "\"µm €\"");
  EXPECT_EQ(quotedText("\xFFx"), "\"\xEF\xBF\xBDx\"");
  std::string all;
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      all.push_back(static_cast<char>(first));
      all.push_back(static_cast<char>(second));
    }
  }
  EXPECT_NO_THROW(nlohmann::json::parse(quotedText(all)).dump());
  // An overlong zero, a surrogate, a character beyond the last.
  for (const char* bad : {"\xC0\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80"})
    EXPECT_NO_THROW(nlohmann::json::parse(quotedText(bad)).dump());
}

TEST(JsonText, ColumnsAreArraysOfAnObject) {
  JsonColumn a, b;
  a.add(1.25, kMm);
  a.add(std::nan(""), kMm);
  b.add(3);
  std::string text = "{";
  appendColumn(text, "a", a);
  appendColumn(text, "b", b);
  EXPECT_EQ(text + "}", R"({"a":[1.25,null],"b":[3]})");
}

}  // namespace
}  // namespace kerfbench::trace
