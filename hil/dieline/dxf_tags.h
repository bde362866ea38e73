// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/progress.h"
#include "hil/dieline/faults.h"

namespace kerfbench::dieline {

// The lower half of the DXF reader: text to records. Debian's dime was measured first and is not used: its
// numbers are floats (2.123456789 arrives as 2.1234567165, an error of 3e-5 mm at 400 mm), it has no line
// numbers, and it frees what it allocated with another operator.

/// One group: its code, its text without surrounding blanks, and the line of the text (counted from 1).
struct DxfTag {
  int code{};
  int line{};
  std::string_view text;
};

/// An object of the file: everything from one group 0 to the next. tags[0] is the group 0 itself.
struct DxfRecord {
  std::span<const DxfTag> tags;
  [[nodiscard]] std::string_view type() const { return tags.front().text; }
  [[nodiscard]] int line() const { return tags.front().line; }
};

/// Numbers and texts of one record; whatever is missing or no number becomes a fault.
class DxfFields {
 public:
  DxfFields(const DxfRecord& record, FaultList& faults) : record_(record), faults_(faults) {}
  [[nodiscard]] std::optional<double> find(int code) const;
  [[nodiscard]] double number(int code) const;  ///< Required: a fault and 0 where it is missing.
  [[nodiscard]] double number(int code, double otherwise) const { return find(code).value_or(otherwise); }
  [[nodiscard]] int integer(int code, int otherwise) const;
  [[nodiscard]] std::string_view text(int code, std::string_view otherwise) const;

 private:
  DxfRecord record_;
  FaultList& faults_;
};

/// A finite number of at most 1e9 in size, or a fault and 0.
double dxfNumber(const DxfTag& tag, FaultList& faults);

struct DxfBlock {
  std::string name;
  double base_x{};
  double base_y{};
  std::vector<DxfRecord> records;
};

/// The parts of the file that a dieline needs. Views point into `text` and `tags`.
struct DxfFile {
  std::string text;
  std::vector<DxfTag> tags;
  std::map<std::string, DxfTag, std::less<>> header;    ///< First group of each variable, by $NAME.
  std::map<std::string, DxfBlock, std::less<>> blocks;  ///< Blocks by name in lower case.
  std::vector<DxfRecord> entities;
  std::vector<DxfRecord> tables;   ///< Section TABLES.
  std::vector<DxfRecord> objects;  ///< Section OBJECTS.
};

/// Cuts `text` (a whole ASCII DXF file) into `file`. `progress` is told the bytes that are done.
/// @throws DielineError where the structure is lost: binary, truncated, no group code.
void parseDxf(std::string text, DxfFile& file, FaultList& faults, base::ShareProgress& progress);

}  // namespace kerfbench::dieline
