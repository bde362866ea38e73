// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerfbench::desk {

/// The Markdown of docs/reference as HTML: code, emphasis, and of links their words. All else is text, so the
/// result has no attribute and no element but <code>, <em> and <strong>.
std::string markdownInline(std::string_view text);

/// Paragraphs, lists of one level and indented or fenced code, with markdownInline() within; tables are left
/// out. Elements besides: <p>, <ul>, <li>, <pre>.
std::string markdownBlocks(std::string_view text);

}  // namespace kerfbench::desk
