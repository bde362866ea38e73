// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/scenario_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "hil/base/input_error.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::string set(const std::string& text, const std::string& path, const ordered_json& value) {
  return edited(text, {{keyPathFrom(path), value}});
}

TEST(ScenarioEdit, KeepsCommentsBlankLinesAndQuotes) {
  const std::string text =
      "# A job.\n"
      "name: 'first'   # names the folder\n"
      "\n"
      "belt:\n"
      "  speed_mm_s: 60  # as the line runs\n"
      "  # lead_s: 0.8\n"
      "\n"
      "checks: {path_mm: 0.05, stray_mm: 0.5}\n";
  EXPECT_EQ(set(text, "belt.speed_mm_s", 75.5),
            base::replaced(text, "speed_mm_s: 60  #", "speed_mm_s: 75.5  #"));
  EXPECT_EQ(set(text, "name", "second"), base::replaced(text, "'first'", "'second'"));
  EXPECT_EQ(set(text, "checks.path_mm", 0.1), base::replaced(text, "0.05", "0.1"));
  EXPECT_EQ(set(text, "checks.uncut_mm", 1), base::replaced(text, "0.5}", "0.5, uncut_mm: 1}"));
  EXPECT_EQ(set(text, "belt.lead_s", 2), base::replaced(text, "runs\n", "runs\n  lead_s: 2\n"));
  EXPECT_EQ(set(text, "print.units", 2), text + "print:\n  units: 2\n");
  EXPECT_EQ(set(text, "checks.path_mm", nullptr), base::replaced(text, "path_mm: 0.05, ", ""));
  EXPECT_EQ(set(text, "checks.stray_mm", nullptr), base::replaced(text, ", stray_mm: 0.5", ""));
  EXPECT_EQ(set(text, "name", nullptr), base::replaced(text, "name: 'first'   # names the folder\n", ""));
  EXPECT_EQ(set(text, "seed", nullptr), text);
}

TEST(ScenarioEdit, TheLastKeyTakesItsSectionWithIt) {
  EXPECT_EQ(set("a: 1\nbelt:\n  speed_mm_s: 60\nz: 2\n", "belt.speed_mm_s", nullptr), "a: 1\nz: 2\n");
  EXPECT_EQ(set("a: {b: {c: 1}, d: 2}\n", "a.b.c", nullptr), "a: {d: 2}\n");
  EXPECT_EQ(set("a: 1\n", "a", nullptr), "");
}

TEST(ScenarioEdit, ListsAndTheirElements) {
  const std::string text =
      "print:\n"
      "  marks:\n"
      "    - x_mm: 1\n"
      "      y_mm: 2  # left\n"
      "    - {x_mm: 3, y_mm: 4}\n"
      "  pitch_mm: 70\n";
  EXPECT_EQ(set(text, "print.marks[0].y_mm", 5), base::replaced(text, "y_mm: 2", "y_mm: 5"));
  EXPECT_EQ(set(text, "print.marks[1].x_mm", 5), base::replaced(text, "x_mm: 3", "x_mm: 5"));
  EXPECT_EQ(set(text, "print.marks[2]", {{"x_mm", 7}, {"y_mm", 8}}),
            base::replaced(text, "y_mm: 4}\n", "y_mm: 4}\n    - {x_mm: 7, y_mm: 8}\n"));
  EXPECT_EQ(set(text, "print.marks[0]", nullptr),
            base::replaced(text, "    - x_mm: 1\n      y_mm: 2  # left\n", ""));
  EXPECT_EQ(set(text, "print.marks", ordered_json::parse(R"([{"x_mm": 1, "y_mm": 2}])")),
            "print:\n  marks:\n    - {x_mm: 1, y_mm: 2}\n  pitch_mm: 70\n");
  EXPECT_EQ(set("a: [1, 2, 3]\n", "a[1]", nullptr), "a: [1, 3]\n");
  EXPECT_EQ(set("a: [1, 2, 3]\n", "a[3]", "x, y"), "a: [1, 2, 3, \"x, y\"]\n");
  EXPECT_THROW(set("a: [1]\n", "a[4]", 1), base::InputError);
}

TEST(ScenarioEdit, SectionsThatAreNotThereOrEmpty) {
  EXPECT_EQ(set("", "a.b", 1), "a:\n  b: 1\n");
  EXPECT_EQ(set("# only words", "a", 1), "# only words\na: 1");
  EXPECT_EQ(set("belt: ~\n", "belt.speed_mm_s", 1), "belt:\n  speed_mm_s: 1\n");
  EXPECT_EQ(set("belt:  # later\nz: 1\n", "belt.speed_mm_s", 1), "belt:  # later\n  speed_mm_s: 1\nz: 1\n");
  EXPECT_EQ(set("a: {}\n", "a.b.c", 1), "a: {b: {c: 1}}\n");
  EXPECT_EQ(set("a: 1", "b", true), "a: 1\nb: true");
}

TEST(ScenarioEdit, TextsThatCouldBeSomethingElseAreQuoted) {
  for (const std::string text :
       {"true", "12",   "~",    "null", "a: b", "a #b", " a", "",    "- a", "[x", "0-3", "*",
        "é",    "a\nb", "it's", "{",    "'",    "\"",   "\\", "1e3", "no",  "%",  "a,b"}) {
    const YAML::Node node = YAML::Load(set("k: 1\nz: {y: 1}\n", "k", text));
    EXPECT_EQ(node["k"].Scalar(), text);
    EXPECT_TRUE(node["k"].IsScalar()) << text;
    EXPECT_EQ(YAML::Load(set("z: {y: 1}\n", "z.y", text))["z"]["y"].Scalar(), text);
    EXPECT_EQ(YAML::Load(set("z: 'old'\n", "z", text))["z"].Scalar(), text);
  }
  EXPECT_EQ(set("k: 1\n", "k", "../dielines/a-b_c.dxf"), "k: ../dielines/a-b_c.dxf\n");
}

TEST(ScenarioEdit, OtherSpellingsOfTextStayWhole) {
  const std::string text =
      "title: >\n"
      "  a long\n"
      "  title\n"
      "\n"
      "note: words that\n"
      "  go on  # here\n"
      "z: \"q # \\\" q\"\n";
  EXPECT_EQ(set(text, "z", 1), base::replaced(text, "\"q # \\\" q\"", "1"));
  EXPECT_EQ(set(text, "note", "short"), base::replaced(text, "words that\n  go on", "short"));
  EXPECT_EQ(set(text, "title", "short"), base::replaced(text, ">\n  a long\n  title", "short"));
  EXPECT_EQ(set(text, "title", nullptr), base::replaced(text, "title: >\n  a long\n  title\n", ""));
}

TEST(ScenarioEdit, LineEndsAndByteOrderMarkStay) {
  EXPECT_EQ(set("\xef\xbb\xbf"
                "a: 1 # é\r\nb: 2\r\n",
                "c.d", 3),
            "\xef\xbb\xbf"
            "a: 1 # é\r\nb: 2\r\nc:\r\n  d: 3\r\n");
  EXPECT_EQ(set("\xef\xbb\xbf"
                "é: 1 # ü\r\nb: 2\r\n",
                "b", 3),
            "\xef\xbb\xbf"
            "é: 1 # ü\r\nb: 3\r\n");
}

TEST(ScenarioEdit, NamesWithPointsGoAsAList) {
  EXPECT_EQ(
      editJson(
          R"({"text": "layers: {A.B: cut}\n", "set": [{"path": ["layers", "A.B"], "value": "crease"}]})"),
      R"({"text":"layers: {A.B: crease}\n"})");
}

TEST(ScenarioEdit, RefusesWhatItCannotDoAlone) {
  EXPECT_THROW(set("a: &x 1\nb: *x\n", "a", 2), base::InputError);
  EXPECT_THROW(set("a: 1\na: 2\n", "a", 3), base::InputError);
  EXPECT_THROW(set("dieline: a.dxf\n", "dieline.unit", "mm"), base::InputError);
  EXPECT_THROW(set("- a\n", "a", 1), base::InputError);
  EXPECT_THROW(set("a: [\n", "a", 1), base::InputError);
  EXPECT_THROW(set("a: 1\n---\nb: 1\n", "a", 2), base::InputError);
  EXPECT_THROW(set("? a\n: 1\n", "a", 2), base::InputError);
  EXPECT_THROW((void)keyPathFrom("a..b"), base::InputError);
  for (const char* body :
       {"", "[]", "{}", R"({"text": 1, "set": []})", R"({"text": "", "set": [{"path": 1, "value": 1}]})",
        R"({"text": "", "set": [{"path": [], "value": 1}]})", R"({"text": "", "set": [{"path": "a"}]})"})
    EXPECT_THROW((void)editJson(body), base::InputError) << body;
  EXPECT_THROW(set(std::string(std::size_t{2} << 20U, ' '), "a", 1), base::InputError);
}

/// A tree read without our own layout: scalars as they read.
ordered_json treeOf(const YAML::Node& node) {
  if (node.IsMap()) {
    ordered_json map = ordered_json::object();
    for (const auto& entry : node) map[entry.first.Scalar()] = treeOf(entry.second);
    return map;
  }
  if (node.IsSequence()) {
    ordered_json list = ordered_json::array();
    for (const YAML::Node& element : node) list.push_back(treeOf(element));
    return list;
  }
  return node.IsNull() ? ordered_json() : ordered_json(node.Scalar());
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// A key of a text: where it stands, and its lines.
struct Key {
  std::vector<std::string> path;
  int first_line{}, last_line{};  ///< From 0; the last one of its value.
  bool is_scalar{};
};

int lastLineOf(const YAML::Node& node) {
  int last = node.Mark().line;
  if (node.IsMap())
    for (const auto& entry : node) last = std::max({last, entry.first.Mark().line, lastLineOf(entry.second)});
  if (node.IsSequence())
    for (const YAML::Node& element : node) last = std::max(last, lastLineOf(element));
  return last;
}

void collect(const YAML::Node& map, std::vector<std::string> path, std::vector<Key>& keys) {
  for (const auto& entry : map) {
    path.push_back(entry.first.Scalar());
    keys.push_back({path, entry.first.Mark().line,
                    std::max(entry.first.Mark().line, lastLineOf(entry.second)), entry.second.IsScalar()});
    if (entry.second.IsMap()) collect(entry.second, path, keys);
    path.pop_back();
  }
}

/// Lines that two texts do not share at their begin and end.
struct Difference {
  std::size_t first{};
  std::vector<std::string> gone, come;
};

Difference differenceOf(const std::vector<std::string>& before, const std::vector<std::string>& after) {
  std::size_t first = 0;
  while (first < before.size() && first < after.size() && before[first] == after[first]) ++first;
  std::size_t same = 0;
  while (same < before.size() - first && same < after.size() - first &&
         before[before.size() - 1 - same] == after[after.size() - 1 - same])
    ++same;
  const auto part = [&](const std::vector<std::string>& lines) {
    return std::vector<std::string>(lines.begin() + std::ptrdiff_t(first),
                                    lines.end() - std::ptrdiff_t(same));
  };
  return {first, part(before), part(after)};
}

/// Random edits of shipped scenarios, the same in each run.
class RandomEdits : public testing::Test {
 protected:
  RandomEdits() {
    for (const auto& entry : fs::recursive_directory_iterator(base::fixture("scenarios")))
      if (entry.path().extension() == ".yaml") files_.push_back(entry.path());
    std::ranges::sort(files_);
  }
  std::size_t below(std::size_t n) { return random_() % n; }
  ordered_json value() {
    switch (below(6)) {
      case 0:
        return static_cast<double>(below(100'000)) / 64.0;
      case 1:
        return below(2) == 0;
      case 2:
        return "text: with 'marks' # and more";
      case 3:
        return ordered_json::array({1.5, "two", 3});
      case 4:
        return {{"a", 1}, {"b", {{"c", "x y"}}}};
      default:
        return "word";
    }
  }

  std::vector<fs::path> files_;
  std::mt19937_64 random_{82};  // NOLINT: the same edits in each run.
};

/// As yaml-cpp reads a value that is set.
ordered_json asRead(const ordered_json& value) {
  if (value.is_structured()) {
    ordered_json read = value;
    for (auto& element : read) element = asRead(element);
    return read;
  }
  if (value.is_string()) return value;
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  return fmt::format("{}", value.get<double>());
}

void prune(ordered_json& tree, const std::vector<std::string>& path, std::size_t depth) {
  if (depth + 1 == path.size()) {
    tree.erase(path[depth]);
    return;
  }
  ordered_json& below = tree[path[depth]];
  prune(below, path, depth + 1);
  if (below.empty()) tree.erase(path[depth]);
}

TEST_F(RandomEdits, ChangeExactlyThatKeyAndTouchNoOtherLine) {
  ASSERT_GT(files_.size(), 60U);
  int changed = 0, removed = 0, added = 0;
  for (int i = 0; i < 1000; ++i) {
    const fs::path& file = files_[static_cast<std::size_t>(i) % files_.size()];
    const std::string text = base::contentOf(file);
    const YAML::Node root = YAML::Load(text);
    std::vector<Key> keys;
    collect(root, {}, keys);
    Key key = keys[below(keys.size())];
    ordered_json expected = treeOf(root);
    KeyEdit edit{key.path, value()};
    const std::size_t what = below(3);
    if (what == 0) {  // Removed.
      edit.value = nullptr;
      prune(expected, key.path, 0);
      ++removed;
    } else if (what == 1) {  // A new key beside this one.
      edit.path.back() = fmt::format("new_key_{}", i);
      ++added;
    } else {
      ++changed;
    }
    if (what != 0) {
      ordered_json* at = &expected;
      for (const std::string& name : edit.path) at = &(*at)[name];
      *at = asRead(edit.value);
    }
    const std::string after = edited(text, {edit});
    SCOPED_TRACE(
        fmt::format("{}: {} = {}\n{}", file.string(), fmt::join(edit.path, "."), edit.value.dump(), after));
    ASSERT_EQ(treeOf(YAML::Load(after)).dump(), expected.dump());
    const Difference difference = differenceOf(linesOf(text), linesOf(after));
    if (what == 1) {
      // Nothing goes, but for the line of a section in braces, which is longer then.
      ASSERT_LE(difference.gone.size(), 1U);
      if (!difference.gone.empty()) ASSERT_THAT(difference.gone[0], testing::HasSubstr("}"));
      continue;
    }
    // What goes is within the lines of the key and, if its section went with it, of that.
    for (std::size_t names = key.path.size() - 1; what == 0 && names > 0; --names) {
      const ordered_json::json_pointer section(
          "/" +
          fmt::format("{}", fmt::join(key.path.begin(), key.path.begin() + std::ptrdiff_t(names), "/")));
      if (expected.contains(section)) break;
      for (const Key& other : keys)
        if (other.path ==
            std::vector<std::string>(key.path.begin(), key.path.begin() + std::ptrdiff_t(names)))
          key = other;
    }
    ASSERT_GE(difference.first, static_cast<std::size_t>(key.first_line));
    // Two equal lines beside each other do not tell which of them went.
    ASSERT_LE(difference.first + difference.gone.size(), static_cast<std::size_t>(key.last_line) + 2);
    ASSERT_LE(difference.gone.size(), static_cast<std::size_t>(key.last_line - key.first_line) + 1);
    if (what == 2 && key.is_scalar && !edit.value.is_structured()) ASSERT_LE(difference.come.size(), 1U);
  }
  EXPECT_GT(std::min({changed, removed, added}), 250);
}

}  // namespace
}  // namespace kerfbench::desk
