// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace kerfbench::base {

/// Blanks of ASCII, line ends included.
inline constexpr std::string_view kBlanks = " \t\r\n\f\v";

/// Text without the blanks at its ends.
std::string_view trimmed(std::string_view text);

/// Text with the capitals A … Z in lower case. Letters of other scripts stay as they are.
std::string lowered(std::string_view text);

/// Foreign text for a message: at most `most_bytes` of it, then "…". Control characters, which a terminal
/// would obey, and bytes that are not UTF-8 become '?'.
std::string printable(std::string_view text, std::size_t most_bytes = 40);
/// Printable text between single quotes.
std::string inQuotes(std::string_view text);

/// Escapes text for HTML, SVG and their attribute values. The text is markupText() then.
std::string escapeHtml(std::string_view text);

/// A number with two digits behind the point; what is rounded to zero has no sign.
std::string hundredths(double value);

}  // namespace kerfbench::base
