// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/job/job.h"
#include "hil/base/text.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kRadiusMismatchMm = 0.005;
/// Largest coordinate; beyond it is a typing error, and its square would eat the decimals of a micrometre.
constexpr double kFarthestMm = 1e5;
constexpr std::size_t kMostBytes = 64U << 20U;
/// Largest number of marks and jumps; each takes a hundred bytes.
constexpr std::size_t kMostMoves = 500'000;
constexpr int kMostFaults = 100;

struct Word {
  char letter{};
  double value{};
};

/// A line in upper case without blanks and comments, and its comment.
struct Line {
  int number{};
  std::string code;
  int entity{-1};
};

/// Entity in a comment such as "E14 cut"; -1 if it begins otherwise.
int entityOf(std::string_view comment) {
  while (!comment.empty() && comment.front() == ' ') comment.remove_prefix(1);
  if (comment.size() < 2 || (comment.front() != 'E' && comment.front() != 'e')) return -1;
  int id = -1;
  const auto [end, error] = std::from_chars(comment.data() + 1, comment.data() + comment.size(), id);
  const bool whole = end == comment.data() + comment.size() || *end == ' ';
  return error == std::errc() && whole && id >= 0 ? id : -1;
}

class Reader {
 public:
  std::vector<Segment> read(const std::string& text) {
    if (text.size() > kMostBytes) throw PlanError("G-code: more than 64 MiB of text");
    int number = 0;
    for (std::size_t from = 0; from < text.size() && !ended_;) {
      const std::size_t to = std::min(text.find('\n', from), text.size());
      readLine(strip(++number, std::string_view(text).substr(from, to - from)));
      from = to + 1;
      if (path_.size() <= kMostMoves) continue;
      fault(number, fmt::format("more than {} moves", kMostMoves));
      break;
    }
    if (count_ > kMostFaults) faults_ += fmt::format("G-code: and {} faults more\n", count_ - kMostFaults);
    bool any = false;
    for (const Segment& segment : path_) any = any || !segment.jump;
    if (!any && faults_.empty()) faults_ = "G-code: it holds no line or arc to cut\n";
    if (!faults_.empty()) {
      faults_.pop_back();
      throw PlanError(faults_);
    }
    return path_;
  }

 private:
  void fault(int line, const std::string& what) {
    if (++count_ <= kMostFaults) faults_ += fmt::format("G-code line {}: {}\n", line, what);
  }

  Line strip(int number, std::string_view raw) {
    Line line{number, {}, -1};
    std::optional<std::string> comment;
    bool nested = false;
    for (const char c : raw) {
      if (comment) {
        if (c == ')') {
          if (const int id = entityOf(*comment); id >= 0) line.entity = id;
          comment.reset();
        } else {
          nested = nested || c == '(';
          *comment += c;
        }
      } else if (c == '(') {
        comment.emplace();
      } else if (c == ';') {
        break;
      } else if (std::isspace(static_cast<unsigned char>(c)) == 0) {
        line.code += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      }
    }
    if (nested) fault(number, "a '(' within a comment: comments do not nest");
    if (comment) fault(number, "a comment without ')'");
    return line;
  }

  /// Splits "G1X2Y3" into words; nullopt after a fault.
  std::optional<std::vector<Word>> split(const Line& line) {
    std::vector<Word> words;
    const char* p = line.code.data();
    const char* const end = p + line.code.size();
    bool good = true;
    while (p != end) {
      const char letter = *p++;
      if (letter < 'A' || letter > 'Z') {
        fault(line.number, base::inQuotes({&letter, 1}) + " where a word should begin");
        return std::nullopt;
      }
      const char* last = p;
      while (last != end && (*last < 'A' || *last > 'Z')) ++last;
      const char* first = p != last && *p == '+' ? p + 1 : p;
      double value = 0.0;
      const auto [stop, error] = std::from_chars(first, last, value, std::chars_format::fixed);
      if (error != std::errc() || stop != last || !std::isfinite(value)) {
        // A line may have millions of such words.
        if (count_ >= kMostFaults) {
          ++count_;
        } else {
          fault(line.number, fmt::format("{} has no number ({})", letter,
                                         base::inQuotes({p, static_cast<std::size_t>(last - p)})));
        }
        good = false;
      }
      words.push_back({letter, value});
      p = last;
    }
    return good ? std::optional(words) : std::nullopt;
  }

  void readLine(const Line& line) {
    if (line.code.empty() || line.code == "LINE" || line.code == "ARC" || line.code == "CIRCLE" ||
        line.code == "%")
      return;
    const auto words = split(line);
    if (!words) return;
    std::array<std::optional<double>, 26> seen{};
    bool good = true;
    bool motion_word = false;
    for (const Word& word : *words) {
      std::optional<double>& value = seen[std::size_t(word.letter - 'A')];
      if (word.letter == 'G') {
        if (word.value == 21.0 || word.value == 90.0) continue;
        if (motion_word) {
          fault(line.number, "more than one of G00 … G03");
          good = false;
        } else if (word.value == 0.0 || word.value == 1.0 || word.value == 2.0 || word.value == 3.0) {
          motion_ = static_cast<int>(word.value);
          motion_word = true;
        } else {
          fault(line.number, fmt::format("G{:g} is not a word of this dialect", word.value));
          good = false;
        }
        continue;
      }
      if (word.letter == 'M' && (word.value == 2.0 || word.value == 30.0)) {
        ended_ = true;
        continue;
      }
      if (std::string_view("XYZIJN").find(word.letter) == std::string_view::npos) {
        fault(line.number, fmt::format("{}{:g} is not a word of this dialect", word.letter, word.value));
        good = false;
      } else if (value) {
        fault(line.number, fmt::format("{} is given twice", word.letter));
        good = false;
      } else if (word.letter != 'N' && std::abs(word.value) > kFarthestMm) {
        fault(line.number, fmt::format("{}{:g} is out of all bounds", word.letter, word.value));
        good = false;
      }
      value = word.value;
    }
    const auto word = [&](char letter) { return seen[std::size_t(letter - 'A')]; };
    const bool moves = word('X') || word('Y') || word('I') || word('J') || word('Z');
    if (good && (moves || motion_word)) move(line, word('X'), word('Y'), word('Z'), word('I'), word('J'));
  }

  void move(const Line& line, std::optional<double> x, std::optional<double> y, std::optional<double> z,
            std::optional<double> i, std::optional<double> j) {
    if (!motion_) return fault(line.number, "a move before any of G00 … G03");
    const bool arc = *motion_ >= 2;
    bool good = true;
    const auto check = [&](bool holds, const std::string& what) {
      if (holds) return;
      fault(line.number, what);
      good = false;
    };
    if (z) check(*z >= 0.0 && *z <= 1.0, fmt::format("Z{:g} is outside 0 … 1", *z));
    if (*motion_ == 0) {
      check(!z || *z == 0.0, "a jump (G00) with the laser on");
      check((x && y) || position_, "the first jump needs X and Y");
    } else {
      if (z) mark_z_ = *z;
      check(mark_z_.has_value(), "no Z yet: laser off or on?");
      check(position_.has_value(), "no start point: a G00 must come first");
    }
    check(arc || (!i && !j), "I and J belong to arcs");
    check(!arc || i || j, "an arc needs I and J");
    Segment segment;
    segment.line = line.number;
    segment.entity = line.entity;
    segment.jump = *motion_ == 0;
    segment.z = segment.jump ? 0.0 : mark_z_.value_or(0.0);
    segment.start_mm = position_.value_or(Vector2d::Zero());
    segment.end_mm = {x.value_or(segment.start_mm.x()), y.value_or(segment.start_mm.y())};
    if (good && arc) good = sweep(segment, {i.value_or(0.0), j.value_or(0.0)});
    if (!good) {
      // The position keeps the faults of one line from causing others in the lines after it.
      if (x || y) position_ = segment.end_mm;
      return;
    }
    if (position_ && segment.lengthMm() > 0.0) path_.push_back(segment);
    position_ = segment.end_mm;
  }

  bool sweep(Segment& segment, const Vector2d& ij) {
    segment.centre_mm = segment.start_mm + ij;
    const Vector2d to = segment.end_mm - segment.centre_mm;
    if (ij.norm() < 1e-4) {
      fault(segment.line, "an arc of radius 0");
      return false;
    }
    if (const double mismatch_mm = std::abs(to.norm() - ij.norm()); mismatch_mm > kRadiusMismatchMm) {
      fault(segment.line, fmt::format("the arc's end lies {:.4f} mm off its circle (radius {:.4f} mm)",
                                      mismatch_mm, ij.norm()));
      return false;
    }
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const Vector2d from = -ij;
    double angle = segment.start_mm == segment.end_mm ? kTurn : std::atan2(cross(from, to), from.dot(to));
    if (angle <= 0.0) angle += kTurn;
    if (*motion_ == 2 && angle < kTurn) angle -= kTurn;
    if (*motion_ == 2 && angle == kTurn) angle = -kTurn;
    segment.sweep_rad = angle;
    return true;
  }

  std::string faults_;
  int count_{};  ///< Number of faults; the text holds the first ones.
  std::vector<Segment> path_;
  std::optional<int> motion_;
  std::optional<Vector2d> position_;
  std::optional<double> mark_z_;
  bool ended_{false};
};

}  // namespace

std::vector<Segment> readGcode(const std::string& text) { return Reader().read(text); }

std::vector<Segment> unitOf(std::vector<Segment> path) {
  const auto marks = [](const Segment& segment) { return !segment.jump; };
  path.erase(std::find_if(path.rbegin(), path.rend(), marks).base(), path.end());
  path.erase(path.begin(), std::find_if(path.begin(), path.end(), marks));
  return path;
}

}  // namespace kerfbench::planner
