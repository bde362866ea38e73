// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

namespace kerfbench::witness {

/// Lines that a second reader knows by the same names, colour and linetype.
struct WitnessedLines {
  std::vector<std::string>
      names;  ///< DXF: the layer. SVG, PDF: layers, from the outermost in. Bytes of the file.
  std::vector<std::string> colours;  ///< Names of the colour, the most exact first; at least one.
  std::string linetype;
  bool is_plotted{true};  ///< False on a DXF layer that is not to be plotted.
  std::string what;       ///< Set for something that it does not follow, which has no length.
  std::size_t count{};    ///< > 0
  double length_mm{};     ///< > 0, finite.
  Eigen::AlignedBox2d box_mm;
};

/// What a second reader says of a drawing, in mm in S.
struct SecondReading {
  std::string reader;  ///< Library and version.
  std::vector<WitnessedLines> lines;
  std::vector<WitnessedLines> unread;
  std::vector<std::string> remarks;  ///< What of the drawing it does not follow: "clip-path".
  std::string missing;               ///< Debian package that it lacks; all else is empty then.
  std::string refused;               ///< Why it cannot read the drawing; all else is empty then.
};

/// An answer that is none; what() is a part of a sentence.
class NoReading : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads the answer, which must have the keys of hil/witness/second_reader.py and no others.
/// @throws NoReading
SecondReading secondReadingFrom(std::string_view text);

}  // namespace kerfbench::witness
