// SPDX-License-Identifier: Apache-2.0
// Comments can be read without their neighbour: none begins in the middle of a sentence that another began.
#include <gtest/gtest.h>

#include "tests/structure/source_text.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;
using kerfbench::test::isWordCharacter;
using kerfbench::test::sourceRoot;
using kerfbench::test::textOf;

constexpr std::string_view kTopFolders[] = {"twin", "hil", "firmware_under_test", "tests"};

/// A comment on one line, or the first line of a block comment.
struct Comment {
  int line{};
  std::size_t column{};
  std::string mark;   // "//", "///", "///<", "//!", "/*", …
  std::string text;   // All that follows the mark on its line.
  bool alone{false};  // No code stands before it.
};

/// Index behind a literal that begins at `at`; `at` itself if none does. Digit separators begin none.
std::size_t behindLiteral(const std::string& source, std::size_t at) {
  const char quote = source[at];
  if (quote != '"' && (quote != '\'' || (at > 0 && isWordCharacter(source[at - 1])))) return at;
  if (quote == '"' && at > 0 && source[at - 1] == 'R') {
    const std::size_t open = source.find('(', at);
    const std::string end = ")" + source.substr(at + 1, open - at - 1) + "\"";
    const std::size_t found = source.find(end, open);
    return found == std::string::npos ? source.size() : found + end.size();
  }
  std::size_t i = at + 1;
  while (i < source.size() && source[i] != quote && source[i] != '\n') i += source[i] == '\\' ? 2 : 1;
  return std::min(i + 1, source.size());
}

Comment commentAt(const std::string& source, std::size_t at, int line, std::size_t line_begin) {
  Comment comment{line, at - line_begin, source.substr(at, 2), "", false};
  std::size_t text = at + 2;
  while (text < source.size() && std::string_view("/*!<").find(source[text]) != std::string_view::npos)
    comment.mark += source[text++];
  comment.text = source.substr(text, source.find('\n', text) - text);
  comment.alone = source.find_first_not_of(" \t", line_begin) == at;
  return comment;
}

std::vector<Comment> commentsOf(const std::string& source) {
  std::vector<Comment> found;
  int line = 1;
  std::size_t line_begin = 0;
  for (std::size_t i = 0; i < source.size();) {
    std::size_t next = i + 1;
    if (source.compare(i, 2, "//") == 0) {
      found.push_back(commentAt(source, i, line, line_begin));
      next = std::min(source.find('\n', i), source.size());
    } else if (source.compare(i, 2, "/*") == 0) {
      found.push_back(commentAt(source, i, line, line_begin));
      const std::size_t end = source.find("*/", i + 2);
      next = end == std::string::npos ? source.size() : end + 2;
    } else {
      next = std::max(next, behindLiteral(source, i));
    }
    for (; i < next; ++i) {
      if (source[i] != '\n') continue;
      ++line;
      line_begin = i + 1;
    }
  }
  return found;
}

/// True if the comment goes on with the one above: both have the same mark, it stands alone, and so does the
/// one above or it is trailing code in the same column.
bool continues(const Comment& above, const Comment& comment) {
  return comment.alone && comment.mark == above.mark && comment.mark.starts_with("//") &&
         comment.line == above.line + 1 && (above.alone || above.column == comment.column);
}

/// True if a comment begins with the rest of a sentence. Formulas and examples are excused: a text that is
/// indented by more than the one blank after the mark, or that begins with a quote or a backtick.
bool isFragment(const std::string& text) {
  static const std::regex kFragment(
      "^ ((Of|By|To|It|Its|They|Their|That|Those|And|But|Or|and|of|by) |\\.\\.\\.|\xE2\x80\xA6)");
  return std::regex_search(text, kFragment);
}

std::vector<Comment> fragmentsOf(const std::string& source) {
  std::vector<Comment> found;
  const std::vector<Comment> comments = commentsOf(source);
  for (std::size_t i = 0; i < comments.size(); ++i) {
    if (i > 0 && continues(comments[i - 1], comments[i])) continue;
    if (isFragment(comments[i].text)) found.push_back(comments[i]);
  }
  return found;
}

TEST(Comments, CanBeReadWithoutTheirNeighbour) {
  std::size_t comments = 0;
  for (const std::string_view top : kTopFolders) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      const fs::path extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp" && extension != ".c") continue;
      const std::string source = textOf(entry.path());
      comments += commentsOf(source).size();
      for (const Comment& fragment : fragmentsOf(source)) {
        ADD_FAILURE() << fs::relative(entry.path(), sourceRoot()).string() << ":" << fragment.line << ": "
                      << fragment.mark << fragment.text;
      }
    }
  }
  EXPECT_GT(comments, 5000U);
}

TEST(Comments, AreFoundOutsideOfLiteralsOnly) {
  const std::vector<Comment> comments = commentsOf(
      "const char* a = \"// no\\\" // no\";  ///< Yes.\n"
      "const auto b = R\"x(/* no */ \" // no)x\";\n"
      "int c = 50'000;  // Yes, too.\n"
      "char d = '\"';  /* Two\n   lines. */ int e;  // Third.\n");
  ASSERT_EQ(comments.size(), 4U);
  EXPECT_EQ(comments[0].mark, "///<");
  EXPECT_EQ(comments[0].text, " Yes.");
  EXPECT_EQ(comments[1].line, 3);
  EXPECT_EQ(comments[2].text, " Two");
  EXPECT_EQ(comments[3].line, 5);
  EXPECT_FALSE(comments[3].alone);
}

TEST(Comments, BeginNoSentenceInTheMiddle) {
  const auto lines = [](const std::string& source) {
    std::vector<int> found;
    for (const Comment& fragment : fragmentsOf(source)) found.push_back(fragment.line);
    return found;
  };
  EXPECT_EQ(lines("/// Of the field.\nint a;  ///< \xE2\x80\xA6 and so on\nint b;  /* by hand */\n"),
            (std::vector{1, 2, 3}));
  EXPECT_EQ(lines("int a;  ///< Speed,\nint b;  ///< and time.\n"), (std::vector{2}))
      << "a field's comment is its own, even below another's";
  EXPECT_EQ(lines("int a;  // Speed\n        // of the belt.\n"), (std::vector<int>{}))
      << "the same comment on two lines";
  EXPECT_EQ(lines("// The speed\n// of the belt.\n/// Of it.\n"), (std::vector{3})) << "another mark";
  EXPECT_EQ(lines("//   by = 2 a\n// \"and\" is a word.\n// Offset of it.\n"), (std::vector<int>{}))
      << "formulas, examples, other words";
}

}  // namespace
