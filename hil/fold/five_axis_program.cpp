// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/five_axis_program.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "hil/base/input_error.h"
#include "hil/base/number_from.h"
#include "hil/base/text.h"
#include "hil/fold/fold_units.h"

namespace kerfbench::fold {
namespace {

constexpr std::string_view kAxes = "XYZAC";
constexpr std::array<double, 5> kMost{1e4, 1e4, 1e4, 360.0, 36000.0};

/// A line without its comments; the fault is empty unless a bracket is not closed.
std::string withoutComments(const std::string& line, std::string& fault) {
  std::string text;
  bool inside = false;
  for (const char c : line) {
    if (!inside && c == ';') break;
    if (c == '(') inside = true;
    if (!inside) text += c;
    if (c == ')') inside = false;
  }
  if (inside) fault = "a bracket is not closed";
  return text;
}

/// Words of a line by their letters.
std::map<char, double> wordsOf(const std::string& text, std::string& fault) {
  std::map<char, double> words;
  const auto refuse = [&](std::string what) {
    if (fault.empty()) fault = std::move(what);
  };
  for (std::size_t i = 0; i < text.size() && fault.empty();) {
    if (std::isspace(static_cast<unsigned char>(text[i])) != 0) {
      ++i;
      continue;
    }
    const char letter = text[i];
    const std::size_t end = std::min(text.find_first_not_of("+-.0123456789", i + 1), text.size());
    const std::string word = text.substr(i, end - i);
    const std::string_view digits = std::string_view(text).substr(i + 1, end - i - 1);
    const auto number = base::numberFrom<double>(digits);
    if (letter < 'A' || letter > 'Z' || !number || !std::isfinite(*number)) {
      refuse(base::inQuotes(word.empty() ? text.substr(i, 1) : word) +
             " is no word: a capital letter and a number");
    } else if (letter != 'G' && letter != 'N' && kAxes.find(letter) == std::string_view::npos) {
      refuse(fmt::format("the letter {} means nothing here", letter));
    } else if (!words.emplace(letter, *number).second) {
      refuse(fmt::format("{} comes twice", letter));
    }
    i = std::max(end, i + 1);
  }
  return words;
}

/// The state of a program while it is read.
class Reader {
 public:
  /// What is wrong with a line; empty if nothing is.
  std::string take(const std::map<char, double>& words, std::vector<twin::FiveAxisMove>& moves) {
    if (const auto g = words.find('G'); g != words.end()) {
      if (g->second != 0.0 && g->second != 1.0) return fmt::format("G{:g} is neither G00 nor G01", g->second);
      cuts_ = g->second == 1.0;
    }
    bool moves_any = false;
    bool names_all = true;
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      const auto word = words.find(kAxes[i]);
      names_all = names_all && word != words.end();
      if (word == words.end()) continue;
      moves_any = true;
      if (!(std::abs(word->second) <= kMost.at(i)))
        return fmt::format("{}{:g} is out of ±{:g}", kAxes[i], word->second, kMost.at(i));
      at_.at(i) = word->second;
    }
    if (!moves_any) return {};
    if (!cuts_) return "a move before the first G00";
    if (moves.empty() && (*cuts_ || !names_all)) return "the first move must be a G00 to X, Y, Z, A and C";
    moves.push_back({{Eigen::Vector3d(at_[0], at_[1], at_[2]), kDegree * at_[3], kDegree * at_[4]}, *cuts_});
    return {};
  }

 private:
  std::optional<bool> cuts_;
  std::array<double, 5> at_{};
};

}  // namespace

std::vector<twin::FiveAxisMove> readFiveAxisProgram(const std::string& text, const std::string& name) {
  std::vector<twin::FiveAxisMove> moves;
  std::string faults;
  Reader reader;
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::string fault;
    const std::map<char, double> words = wordsOf(withoutComments(line, fault), fault);
    if (fault.empty()) fault = reader.take(words, moves);
    if (!fault.empty()) faults += fmt::format("{}{}:{}: {}", faults.empty() ? "" : "\n", name, number, fault);
  }
  if (faults.empty() && std::ranges::none_of(moves, &twin::FiveAxisMove::cuts))
    faults = fmt::format("{}: the program cuts nothing", name);
  if (!faults.empty()) throw base::InputError(faults);
  return moves;
}

}  // namespace kerfbench::fold
