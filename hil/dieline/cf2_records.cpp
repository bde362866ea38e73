// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/cf2_records.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "hil/dieline/readers.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;

constexpr double kFarthest = 1e6;            // Coordinates beyond are no sheet's, in mm or inches.
constexpr double kMostCentreMiss_mm = 0.05;  // The format allows it for rounding.

/// Fields of a record, without blanks around them. No record has a meaning for more than these.
std::vector<std::string_view> fieldsOf(std::string_view record) {
  constexpr std::size_t kMostFields = 16;
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = record.find(',');
    fields.push_back(trimmed(record.substr(0, comma)));
    if (comma == std::string_view::npos || fields.size() == kMostFields) return fields;
    record.remove_prefix(comma + 1);
  }
}

class Cf2Reader {
 public:
  Cf2Reader(const std::string& text, FaultList& faults, base::ShareProgress& progress)
      : text_(text), faults_(faults), progress_(progress) {}

  Cf2File read() {
    while (const auto record = nextLine()) {
      if (record->empty()) continue;
      if (*record == "$EOF") {
        file_.has_end = true;
        break;
      }
      const auto fields = fieldsOf(*record);
      const bool is_known = block_ == nullptr ? outside(fields) : inside(fields);
      // Words of a file that is no drawing at all are nobody's business.
      if (!is_known && !begun_) faults_.fatal(line_, "begins with no record of CF2: it is no CF2 drawing");
      begun_ = true;
      if (!is_known) {
        faults_.add(line_, fmt::format("record {} is not known{}", inQuotes(fields[0]),
                                       block_ == nullptr ? " outside of MAIN and SUB" : ""));
      }
      if (records_ > kMostEntities) faults_.fatal(line_, fmt::format("more than {} records", kMostEntities));
    }
    if (block_ != nullptr || skips_)
      faults_.add(line_, fmt::format("ends within a block: {} is never ended", inQuotes(block_name_)));
    if (!has_main_) faults_.add(0, "has no MAIN: it is no CF2 drawing, or only a part of one");
    if (has_main_ && file_.unit_mm == 0.0)
      faults_.add(file_.main.line, "MAIN says neither UM nor UI: are these millimetres or inches?");
    return std::move(file_);
  }

 private:
  std::optional<std::string_view> nextLine() {
    if (position_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find_first_of("\r\n", position_), text_.size());
    const std::string_view line(text_.data() + position_, end - position_);
    position_ = end + (text_.compare(end, 2, "\r\n") == 0 ? 2 : 1);
    ++line_;
    progress_.done(position_);
    return trimmed(line);
  }

  /// Records that begin a block, or stand before the first.
  bool outside(const std::vector<std::string_view>& fields) {
    if (skips_) {
      skips_ = fields[0] != "END";
      return true;
    }
    if (fields[0] == "$BOF" || fields[0] == "V2" || fields[0] == "END") return true;
    // Who ordered what, and what the maker's own program keeps.
    if (fields[0] == "ORDER" || fields[0] == "AUX") return skips_ = true;
    if (fields[0] == "V1") faults_.fatal(line_, "is of revision 1 of the format; save it as CFF2");
    if (fields[0] == "MAIN") {
      if (has_main_) faults_.add(line_, "a second MAIN");
      has_main_ = true;
      return begin(file_.main, "MAIN");
    }
    if (fields[0] == "SUB" && fields.size() > 1) {
      const auto [sub, is_new] = file_.subs.try_emplace(std::string(fields[1]));
      if (!is_new) faults_.add(line_, fmt::format("a second SUB {}", inQuotes(fields[1])));
      return begin(sub->second, "SUB " + std::string(fields[1]));
    }
    return false;
  }

  bool begin(Cf2Block& block, std::string name) {
    block_ = &block;
    block_->line = line_;
    block_name_ = std::move(name);
    return true;
  }

  bool inside(const std::vector<std::string_view>& fields) {
    const std::string_view kind = fields[0];
    if (kind == "END") {
      block_ = nullptr;
    } else if (kind == "UM" || kind == "UI") {
      const double unit_mm = kind == "UM" ? 1.0 : 25.4;
      if (file_.unit_mm != 0.0 && file_.unit_mm != unit_mm) faults_.add(line_, "both UM and UI");
      file_.unit_mm = unit_mm;
    } else if (kind == "SCALE") {
      const auto v = numbers(fields, 1, 2);
      if (v && ((*v)[0] != 1.0 || (*v)[1] != 1.0)) {
        faults_.add(line_,
                    fmt::format("SCALE,{:g},{:g}: the drawing is not of its real size; export it 1 : 1",
                                (*v)[0], (*v)[1]));
      }
    } else if (kind == "T") {
      ++file_.texts;
      nextLine();  // The words stand in the next line, whatever they look like.
    } else if (kind == "L") {
      addLine(fields);
    } else if (kind == "A") {
      addArc(fields);
    } else if (kind == "C") {
      addCopy(fields);
    } else {
      return kind == "LL" || kind == "UR";  // Limits of the drawing, which its lines tell as well.
    }
    return true;
  }

  /// `count` numbers from field `first`, or nothing where one is missing or none.
  std::optional<std::vector<double>> numbers(const std::vector<std::string_view>& fields, std::size_t first,
                                             std::size_t count) {
    if (fields.size() < first + count) {
      faults_.add(line_, fmt::format("{} has {} fields, {} are needed", fields[0], fields.size() - 1,
                                     first + count - 1));
      return std::nullopt;
    }
    std::vector<double> values;
    for (std::size_t i = first; i < first + count; ++i) {
      const auto value = parsedNumber<double>(fields[i]);
      if (!value || !(std::abs(*value) <= kFarthest)) {
        faults_.add(line_, fmt::format("field {} of {} is no number of a drawing: {}", i, fields[0],
                                       inQuotes(fields[i])));
        return std::nullopt;
      }
      values.push_back(*value);
    }
    return values;
  }

  /// What L and A have in common: the rule in front, its bridges at the end, which may be left out.
  std::optional<Cf2Curve> rule(const std::vector<std::string_view>& fields, std::size_t bridges) {
    Cf2Curve curve;
    curve.line = line_;
    ++records_;
    const auto points = numbers(fields, 1, 1);
    const auto type = fields.size() > 2 ? parsedNumber<int>(fields[2]) : std::nullopt;
    if (!points) return std::nullopt;
    if (!type || *type < 0) {
      faults_.add(line_, fmt::format("{} has no type of line", fields[0]));
      return std::nullopt;
    }
    curve.rule_pt = (*points)[0];
    curve.type = *type;
    if (fields.size() > bridges && !fields[bridges].empty()) {
      const auto count = parsedNumber<double>(fields[bridges]);
      if (!count || *count < 0 || *count > 1e4 || *count != std::floor(*count)) {
        faults_.add(line_, fmt::format("{} has {} bridges", fields[0], inQuotes(fields[bridges])));
        return std::nullopt;
      }
      curve.bridges = static_cast<int>(*count);
    }
    return curve;
  }

  void addLine(const std::vector<std::string_view>& fields) {
    auto curve = rule(fields, 8);
    const auto v = numbers(fields, 4, 4);
    if (!curve || !v) return;
    curve->curve = LineCurve{{(*v)[0], (*v)[1]}, {(*v)[2], (*v)[3]}};
    block_->curves.push_back(std::move(*curve));
  }

  void addArc(const std::vector<std::string_view>& fields) {
    auto curve = rule(fields, 11);
    const auto v = numbers(fields, 4, 7);
    if (!curve || !v) return;
    const Vector2d start((*v)[0], (*v)[1]);
    const Vector2d end((*v)[2], (*v)[3]);
    const Vector2d stated((*v)[4], (*v)[5]);
    const double sense = (*v)[6];
    if (sense != 1.0 && sense != -1.0) {
      faults_.add(line_, fmt::format("A has the sense {:g}; 1 is counter-clockwise, -1 clockwise", sense));
      return;
    }
    const Vector2d chord = end - start;
    Vector2d centre = stated;
    // Both ends are rounded, and so is the centre. Lines meet the ends, so the centre gives way.
    if (chord.norm() > 0.0) {
      const Vector2d across = Vector2d(-chord.y(), chord.x()).normalized();
      centre = (start + end) / 2 + across * across.dot(stated - (start + end) / 2);
    }
    const double unit_mm = file_.unit_mm == 0.0 ? 1.0 : file_.unit_mm;
    const double miss_mm = (centre - stated).norm() * unit_mm;
    const double radius = (start - centre).norm();
    if (!(radius > 0.0) || miss_mm > kMostCentreMiss_mm) {
      faults_.add(line_, radius > 0.0
                             ? fmt::format("the centre of A is {:.3f} mm from where its ends put it; "
                                           "{} mm may be rounding",
                                           miss_mm, kMostCentreMiss_mm)
                             : "A has no radius");
      return;
    }
    const double from = std::atan2(start.y() - centre.y(), start.x() - centre.x());
    double sweep = std::atan2(end.y() - centre.y(), end.x() - centre.x()) - from;
    if (sense > 0 && sweep <= 0) sweep += 2 * std::numbers::pi;
    if (sense < 0 && sweep >= 0) sweep -= 2 * std::numbers::pi;
    curve->curve = ArcCurve{centre, radius, from, sweep};
    block_->curves.push_back(std::move(*curve));
  }

  void addCopy(const std::vector<std::string_view>& fields) {
    ++records_;
    const auto v = numbers(fields, 2, 5);
    if (!v) return;
    Cf2Copy copy{std::string(fields[1]), {(*v)[0], (*v)[1]}, (*v)[2], {(*v)[3], (*v)[4]}, line_};
    if (copy.scale.x() == 0.0 || copy.scale.y() == 0.0) {
      faults_.add(line_, fmt::format("C flattens {} to nothing", inQuotes(copy.name)));
      return;
    }
    block_->copies.push_back(std::move(copy));
  }

  const std::string& text_;
  FaultList& faults_;
  base::ShareProgress& progress_;
  Cf2File file_;
  Cf2Block* block_{};
  std::string block_name_{"ORDER"};
  std::size_t position_{};
  std::size_t records_{};
  int line_{};
  bool has_main_{};
  bool begun_{};  ///< A record was known.
  bool skips_{};
};

}  // namespace

Cf2File readCf2Records(const std::string& text, FaultList& faults, base::ShareProgress& progress) {
  return Cf2Reader(text, faults, progress).read();
}

}  // namespace kerfbench::dieline
