// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace kerfbench::base {

/// Text as a terminal or the log of a CI server may have it, whoever wrote its words: control characters but
/// line feeds and tabs, and bytes that are not UTF-8, become '?'. What such servers would obey is broken up:
/// "::" at the begin of a line, "##[", "##vso[" and "##teamcity[" anywhere.
std::string forTerminal(std::string_view text);

/// The same for JSON, which stays the same value: by escapes within its strings.
std::string jsonForTerminal(std::string_view json);

/// Writes text to standard output or standard error by forTerminal(). Everything that the programs say goes
/// through here (tests/structure/terminal_test.cpp).
void toTerminal(std::FILE* stream, std::string_view text);

/// Writes what is no message, byte for byte: JSON by jsonForTerminal(), scripts, escape sequences of our own.
void toTerminalAsItIs(std::FILE* stream, std::string_view text);

}  // namespace kerfbench::base
