// SPDX-License-Identifier: Apache-2.0
#include "hil/base/yaml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace kerfbench::base {
namespace {

using testing::HasSubstr;

class YamlReaderTest : public testing::Test {
 protected:
  YamlReader open(const std::string& content) {
    std::ofstream(path_) << content;
    return YamlReader::openFile(path_);
  }
  static std::string faultsOf(YamlReader& reader) {
    try {
      reader.finish();
    } catch (const ConfigError& e) {
      return e.what();
    }
    return {};
  }
  std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) / "kerfbench_yaml_reader.yaml";
};

TEST_F(YamlReaderTest, ReadsWhatIsThereAndFallsBackWhereAllowed) {
  auto file = open(
      "a: 1.5\nb: [1, 2]\nc: {d: yes}\ne: left\nf:\n  - {x: 1}\n  - {x: 2}\ng: {CUT: cut, '*': ignore}\n");
  EXPECT_EQ(file.number("a", {.min = 0, .max = 2}), 1.5);
  EXPECT_EQ(file.numbers("b", 2), (std::vector<double>{1, 2}));
  EXPECT_TRUE(file.section("c").boolean("d"));
  EXPECT_EQ(file.choice("e", {"left", "right"}), "left");
  EXPECT_EQ(file.number("missing", {.fallback = 7.0}), 7.0);
  auto list = file.list("f");
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].integer("x", {}), 1);
  EXPECT_EQ(list[1].integer("x", {}), 2);
  EXPECT_EQ(file.pairs("g").size(), 2U);
  EXPECT_EQ(faultsOf(file), "");
}

TEST_F(YamlReaderTest, ReadsListsOfTexts) {
  auto file = open("a: ['$X', 5, \"b: c\"]\nb:\n  - {x: 1}\n  - text\nc: text\n");
  EXPECT_EQ(file.texts("a"), (std::vector<std::string>{"$X", "5", "b: c"}));
  EXPECT_EQ(file.texts("b"), (std::vector<std::string>{"text"}));
  EXPECT_TRUE(file.texts("c").empty());
  EXPECT_TRUE(file.texts("missing").empty());
  const std::string faults = faultsOf(file);
  EXPECT_THAT(faults, HasSubstr(":2: b: element 0 is not a text"));
  EXPECT_THAT(faults, HasSubstr(":5: c: expected a list of texts"));
  EXPECT_EQ(std::ranges::count(faults, '\n'), 1);
}

TEST_F(YamlReaderTest, ListsEveryFaultWithItsLineAtOnce) {
  auto file = open("a: 5\nb: text\nsection:\n  c: 1\n  typo: 2\nf:\n  - {x: 1, y: 3}\n");
  file.number("a", {.min = 0, .max = 2});
  file.number("b", {});
  {
    auto section = file.section("section");
    section.number("c", {});
    section.number("d", {});
  }  // The reader of a section may be destroyed before finish().
  file.list("f")[0].number("x", {});
  const std::string faults = faultsOf(file);
  EXPECT_THAT(faults, HasSubstr(":1: a: 5 is outside 0 … 2"));
  EXPECT_THAT(faults, HasSubstr(":2: b: 'text' is not a number"));
  EXPECT_THAT(faults, HasSubstr(":3: section.d: missing"));
  EXPECT_THAT(faults, HasSubstr(":5: section.typo: unknown key (known here: c, d)"));
  EXPECT_THAT(faults, HasSubstr(":7: f[0].y: unknown key"));
}

TEST_F(YamlReaderTest, TellsWhichKeyAMistypedOneWasMeantToBe) {
  auto file = open("speed_mms: 1\n");
  file.number("speed_mm_s", {.fallback = 1.0});
  file.number("start_mm", {.fallback = 1.0});
  EXPECT_THAT(faultsOf(file), HasSubstr("speed_mms: unknown key. Did you mean speed_mm_s? (known here: "));
}

TEST_F(YamlReaderTest, RefusesWhatIsNoMapping) {
  EXPECT_THROW(open("- 1\n- 2\n"), ConfigError);
  EXPECT_THROW(open("a: [1, 2\n"), ConfigError);
  EXPECT_THROW(YamlReader::openFile("/nonexistent.yaml"), ConfigError);
}

TEST_F(YamlReaderTest, RefusesNotANumberAndInfinity) {
  auto file = open("a: .nan\nb: .inf\n");
  file.number("a", {});
  file.number("b", {});
  const std::string faults = faultsOf(file);
  EXPECT_THAT(faults, HasSubstr(":1: a"));
  EXPECT_THAT(faults, HasSubstr(":2: b"));
}

TEST_F(YamlReaderTest, ComplainsOfAKeyGivenTwice) {
  auto file = open("a: 1\na: 2\n");
  file.number("a", {});
  EXPECT_THAT(faultsOf(file), HasSubstr(":2: a: given twice"));
}

TEST_F(YamlReaderTest, ExtendsAnotherFileKeyByKeyAndNamesTheRightFileInFaults) {
  const auto base = path_.parent_path() / "kerfbench_yaml_base.yaml";
  std::ofstream(base) << "a: 1\nsection: {x: 1, y: 2}\nwrong: 1\n";
  auto file = open("extends: kerfbench_yaml_base.yaml\nsection: {y: 3, other: 4}\n");
  EXPECT_EQ(file.number("a", {}), 1.0);
  auto section = file.section("section");
  EXPECT_EQ(section.number("x", {}), 1.0);
  EXPECT_EQ(section.number("y", {}), 3.0);
  EXPECT_EQ(file.folderOf("a"), base.parent_path());
  const std::string faults = faultsOf(file);
  EXPECT_THAT(faults, HasSubstr("kerfbench_yaml_base.yaml:3: wrong: unknown key"));
  EXPECT_THAT(faults, HasSubstr("kerfbench_yaml_reader.yaml:2: section.other: unknown key"));
}

TEST_F(YamlReaderTest, RefusesAFileThatExtendsItself) {
  EXPECT_THROW(open("extends: kerfbench_yaml_reader.yaml\n"), ConfigError);
}

TEST_F(YamlReaderTest, ChecksEachNumberOfAList) {
  auto file = open("a: [1, 5]\nb: [1, -2]\n");
  EXPECT_EQ(file.numbers("a", 2, {.min = 0, .max = 5}), (std::vector<double>{1, 5}));
  EXPECT_EQ(file.numbers("missing", 3, {.min = 1, .max = 5, .fallback = 2.0}),
            (std::vector<double>{2, 2, 2}));
  file.numbers("b", 2, {.min = 0, .max = 5});
  EXPECT_THAT(faultsOf(file), HasSubstr(":2: b: -2 is outside 0 … 5"));
}

TEST_F(YamlReaderTest, RemembersWhatWasAskedForWithItsRange) {
  auto file = open("a: 1\nlist:\n  - {x: 1}\n  - {x: 2}\n");
  EXPECT_TRUE(file.has("a"));
  file.number("a", {.min = 0, .max = 2});
  file.section("b").number("c", {.min = 3, .max = 4, .fallback = 3.5});
  for (auto& element : file.list("list")) element.number("x", {.min = 1, .max = 9});
  const auto asked = file.asked();
  ASSERT_EQ(asked.size(), 4U);
  EXPECT_EQ(asked[0].key, "a");
  EXPECT_TRUE(asked[0].given);
  EXPECT_EQ(asked[0].range.value().max, 2.0);
  EXPECT_EQ(asked[1].key, "b.c");
  EXPECT_FALSE(asked[1].given);
  EXPECT_EQ(asked[1].range.value().fallback, 3.5);
  EXPECT_EQ(asked[2].key, "list");
  EXPECT_EQ(asked[3].key, "list[].x");
}

TEST_F(YamlReaderTest, NamesThePlaceOfAKeyInWhicheverFileGivesIt) {
  const auto base = path_.parent_path() / "kerfbench_yaml_base.yaml";
  std::ofstream(base) << "a: {b: 1,\n    c: 2}\n";
  auto file = open("extends: " + base.string() + "\n\na: {b: 3}\n");
  auto a = file.section("a");
  a.number("b", {});
  a.number("c", {});
  EXPECT_EQ(file.placeOf("a.b"), path_.string() + ":3");
  EXPECT_EQ(file.placeOf("a.c"), base.string() + ":2");
  EXPECT_EQ(file.placeOf("a.nothing"), path_.string() + ":3");
  EXPECT_EQ(file.placeOf("nothing"), path_.string() + ":1");
}

TEST_F(YamlReaderTest, AKeyThatIsTakenAwayIsAsIfItWereNotThere) {
  const auto base = path_.parent_path() / "kerfbench_yaml_base.yaml";
  std::ofstream(base) << "a: 1\nb: {c: 2}\n";
  auto file = open("extends: " + base.string() + "\na: ~\nb: ~\n");
  EXPECT_FALSE(file.has("a"));
  EXPECT_FALSE(file.has("b"));
  EXPECT_EQ(file.number("a", {.fallback = 9.0}), 9.0);
  EXPECT_EQ(faultsOf(file), "");
}

TEST(YamlValue, IsWhatMayStandBehindAKey) {
  for (const char* good : {"1", "fast", "[1, 2]", "{a: 1}", "~", "'x: y'"})
    EXPECT_TRUE(isYamlValue(good)) << good;
  for (const char* bad : {"", "[1", "a\nb: 2", "a: b", "}"}) EXPECT_FALSE(isYamlValue(bad)) << bad;
}

TEST_F(YamlReaderTest, RefusesControlCharactersInTextsAndShowsNone) {
  auto file = open(
      "a: \"\\e[31m\"\nb: [\"x\\x9b2J\"]\nc: {\"\\a\": cut}\n\"k\\e[2J\": 1\nd: \"two\\nlines\\tare text\"\n"
      "e: \"\\e]0;x\"\nf: \"\\e[1m\"\n");
  (void)file.text("a");
  (void)file.texts("b");
  (void)file.pairs("c");
  EXPECT_EQ(file.text("d"), "two\nlines\tare text");
  (void)file.choice("e", {"left"});
  (void)file.number("f", {});
  const std::string faults = faultsOf(file);
  EXPECT_THAT(faults, HasSubstr("yaml:1: a: has a control character"));
  EXPECT_THAT(faults, HasSubstr("yaml:2: b: element 0 has a control character"));
  EXPECT_THAT(faults, HasSubstr("yaml:3: c: has a control character"));
  EXPECT_THAT(faults, HasSubstr("yaml:4: k?[2J: unknown key"));
  EXPECT_THAT(faults, HasSubstr("'?]0;x' is none of: left"));
  EXPECT_THAT(faults, HasSubstr("'?[1m' is not a number"));
  EXPECT_EQ(faults.find('\x1b'), std::string::npos);
  EXPECT_EQ(faults.find('\x9b'), std::string::npos);
}

TEST_F(YamlReaderTest, TakesOneDocumentAlone) {
  EXPECT_THROW(open("a: 1\n---\na: 2\n"), ConfigError);
  auto file = open("---\na: 1\n...\n");
  EXPECT_EQ(file.integer("a", {}), 1);
  auto empty_behind = open("a: 1\n---\n");
  EXPECT_EQ(empty_behind.integer("a", {}), 1);
}

TEST_F(YamlReaderTest, SaysNoMoreThanSomebodyCanRead) {
  std::string many = "known: 1\n";
  for (int i = 0; i < 20'000; ++i) many += "key" + std::to_string(i) + ": 1\n";
  auto file = open(many);
  EXPECT_EQ(file.integer("known", {}), 1);
  const std::string faults = faultsOf(file);
  EXPECT_THAT(faults, HasSubstr(": 19800 faults more"));
  EXPECT_LT(faults.size(), 64U * 1024U);
  auto one = open("known: 1\n" + std::string(1000, 'k') + ": 1\n");
  EXPECT_EQ(one.integer("known", {}), 1);
  EXPECT_LT(faultsOf(one).size(), 400U);
}

}  // namespace
}  // namespace kerfbench::base
