// SPDX-License-Identifier: Apache-2.0
#include "hil/witness/second_reading.h"

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"

namespace kerfbench::witness {
namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 5;  // Object, list, object, list, number.

/// The whole text; nested no deeper than an answer is, and no key twice in an object.
Json parsed(std::string_view text) {
  std::vector<std::set<std::string>> keys;
  const auto check = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > kDeepest) throw NoReading("is nested too deeply");
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      throw NoReading(fmt::format("has the key {} twice", base::inQuotes(value.get<std::string>())));
    return true;
  };
  try {
    return Json::parse(text, check);
  } catch (const Json::exception& error) {
    throw NoReading(fmt::format("is no JSON: {}", base::printable(error.what(), 160)));
  }
}

/// An object of these very keys.
const Json& objectOf(const Json& value, std::initializer_list<const char*> keys) {
  bool fits = value.is_object() && value.size() == keys.size();
  for (const char* key : keys) fits = fits && value.contains(key);
  if (!fits) {
    std::string names;
    for (const char* key : keys) names += (names.empty() ? "" : ", ") + std::string(key);
    throw NoReading(fmt::format("lacks an object with the keys {}", names));
  }
  return value;
}

std::string textAt(const Json& object, const char* key) {
  const Json& value = object.at(key);
  if (!value.is_string()) throw NoReading(fmt::format("has no text for {}", key));
  return value.get<std::string>();
}

const Json& listAt(const Json& object, const char* key) {
  const Json& value = object.at(key);
  if (!value.is_array()) throw NoReading(fmt::format("has no list for {}", key));
  return value;
}

double finite(const Json& value, const char* key) {
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!std::isfinite(number)) throw NoReading(fmt::format("has no number for {}", key));
  return number;
}

/// Bytes of percent-encoded text.
std::string decoded(const std::string& text, const char* key) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      bytes += text[i];
      continue;
    }
    unsigned char byte = 0;
    const char* const digits = text.data() + i + 1;
    if (i + 2 >= text.size() || std::from_chars(digits, digits + 2, byte, 16).ptr != digits + 2)
      throw NoReading(fmt::format("has a broken name for {}", key));
    bytes += static_cast<char>(byte);
    i += 2;
  }
  return bytes;
}

std::vector<std::string> namesAt(const Json& object, const char* key) {
  std::vector<std::string> names;
  for (const Json& name : listAt(object, key)) {
    if (!name.is_string()) throw NoReading(fmt::format("has no list of texts for {}", key));
    names.push_back(decoded(name.get<std::string>(), key));
  }
  return names;
}

/// What lines and things that are not followed have in common.
WitnessedLines knownBy(const Json& object) {
  WitnessedLines lines;
  lines.names = namesAt(object, "names");
  lines.colours = namesAt(object, "colours");
  if (lines.colours.empty()) throw NoReading("has lines without a colour");
  lines.linetype = decoded(textAt(object, "linetype"), "linetype");
  const Json& plotted = object.at("plotted");
  if (!plotted.is_boolean()) throw NoReading("has neither true nor false for plotted");
  lines.is_plotted = plotted.get<bool>();
  const Json& count = object.at("count");
  if (!count.is_number_unsigned() || count.get<std::size_t>() == 0) throw NoReading("has no count of lines");
  lines.count = count.get<std::size_t>();
  return lines;
}

WitnessedLines linesFrom(const Json& value) {
  const Json& object =
      objectOf(value, {"names", "colours", "linetype", "plotted", "count", "length_mm", "box_mm"});
  WitnessedLines lines = knownBy(object);
  lines.length_mm = finite(object.at("length_mm"), "length_mm");
  if (!(lines.length_mm > 0)) throw NoReading("has a length that is not > 0");
  const Json& box = listAt(object, "box_mm");
  if (box.size() != 4) throw NoReading("has a box that is not of four numbers");
  Eigen::Vector4d corners;
  for (std::size_t i = 0; i < 4; ++i) corners(static_cast<Eigen::Index>(i)) = finite(box.at(i), "box_mm");
  if (!(corners(0) <= corners(2) && corners(1) <= corners(3)))
    throw NoReading("has a box that is inside out");
  lines.box_mm = Eigen::AlignedBox2d(corners.head<2>(), corners.tail<2>());
  return lines;
}

}  // namespace

SecondReading secondReadingFrom(std::string_view text) {
  const Json json = parsed(text);
  SecondReading reading;
  if (json.is_object() && json.contains("missing")) {
    reading.missing = textAt(objectOf(json, {"missing"}), "missing");
    if (reading.missing.empty()) throw NoReading("does not say what is missing");
    return reading;
  }
  if (json.is_object() && json.contains("refused")) {
    reading.refused = textAt(objectOf(json, {"refused"}), "refused");
    if (reading.refused.empty()) throw NoReading("does not say why it refuses the drawing");
    return reading;
  }
  const Json& object = objectOf(json, {"reader", "mm_per_unit", "groups", "unread", "remarks"});
  reading.reader = textAt(object, "reader");
  (void)finite(object.at("mm_per_unit"), "mm_per_unit");
  for (const Json& group : listAt(object, "groups")) reading.lines.push_back(linesFrom(group));
  for (const Json& value : listAt(object, "unread")) {
    const Json& thing = objectOf(value, {"names", "colours", "linetype", "plotted", "count", "what"});
    reading.unread.push_back(knownBy(thing));
    reading.unread.back().what = decoded(textAt(thing, "what"), "what");
  }
  for (const Json& remark : listAt(object, "remarks")) {
    if (!remark.is_string()) throw NoReading("has no list of texts for remarks");
    reading.remarks.push_back(remark.get<std::string>());
  }
  return reading;
}

}  // namespace kerfbench::witness
