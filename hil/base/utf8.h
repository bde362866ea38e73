// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace kerfbench::base {

/// Bytes of the character at the begin of `text`, 0 where there is no well-formed one (RFC 3629). Not empty.
std::size_t characterBytes(std::string_view text);

/// Whether a terminal would obey the character: C0, DEL, C1.
bool isControl(std::string_view character);

/// Whether a text has a character that a terminal would obey; line feeds and tabs as well.
bool hasControl(std::string_view text);

/// Text that HTML and XML 1.0 can hold, in UTF-8: control characters but line ends and tabs, bytes that are
/// not UTF-8 and the characters U+FFFE and U+FFFF become U+FFFD.
std::string markupText(std::string_view text);

}  // namespace kerfbench::base
