// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/intel_hex.h"

#include <cstdint>
#include <vector>

namespace kerfbench::emulator {
namespace {

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/// Record of a line: length, address, type, data, checksum.
class Record {
 public:
  Record(std::string_view line, const std::string& path, std::string where)
      : path_(path), where_(std::move(where)) {
    if (line.front() != ':') refuse("a record must start with ':'");
    line.remove_prefix(1);
    std::uint8_t sum = 0;
    for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
      const int high = hexDigit(line[i]);
      const int low = hexDigit(line[i + 1]);
      if (high < 0 || low < 0) refuse("not a hexadecimal digit");
      bytes_.push_back(static_cast<std::uint8_t>(high * 16 + low));
      sum = static_cast<std::uint8_t>(sum + bytes_.back());
    }
    if (line.size() % 2 != 0 || bytes_.size() < 5 || bytes_.size() != 5U + bytes_[0])
      refuse("the record's length is wrong");
    if (sum != 0) refuse("bad checksum");
  }
  [[noreturn]] void refuse(const std::string& what) const { refuseImage(path_, where_, what); }
  [[nodiscard]] std::uint8_t type() const { return bytes_[3]; }
  [[nodiscard]] std::uint64_t address() const { return bytes_[1] * 256U + bytes_[2]; }
  [[nodiscard]] std::span<const std::uint8_t> data() const { return std::span(bytes_).subspan(4, bytes_[0]); }
  /// The two bytes of a record that moves the base of addresses.
  [[nodiscard]] std::uint64_t base() const {
    if (bytes_[0] != 2) refuse("an address record must have two bytes");
    return bytes_[4] * 256U + bytes_[5];
  }
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  const std::string& path_;
  std::string where_;
  std::vector<std::uint8_t> bytes_;
};

enum RecordType : std::uint8_t {
  kData = 0,
  kEnd = 1,
  kSegmentBase = 2,
  kSegmentStart = 3,
  kLinearBase = 4,
  kLinearStart = 5
};

}  // namespace

void readIntelHex(std::string_view text, const std::string& path, const Placer& place) {
  std::uint64_t base = 0;
  bool ended = false;
  std::size_t line_number = 0;
  while (!text.empty()) {
    const std::string where = ":" + std::to_string(++line_number);
    const auto eol = text.find('\n');
    std::string_view line = text.substr(0, eol);
    text.remove_prefix(eol == std::string_view::npos ? text.size() : eol + 1);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (line.empty()) continue;
    if (ended) refuseImage(path, where, "text after the end-of-file record");
    const Record record(line, path, where);
    switch (record.type()) {
      case kData:
        place(base + record.address(), record.data(), record.where());
        break;
      case kEnd:
        ended = true;
        break;
      case kSegmentBase:
        base = record.base() << 4U;
        break;
      case kLinearBase:
        base = record.base() << 16U;
        break;
      case kSegmentStart:
      case kLinearStart:
        break;  // A controller starts where its reset says.
      default:
        record.refuse("unknown record type " + std::to_string(record.type()));
    }
  }
  if (!ended) refuseImage(path, "", "no end-of-file record: the file is truncated");
}

}  // namespace kerfbench::emulator
