// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/clip_page.h"

#include <cerrno>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/installation.h"
#include "hil/report/html_text.h"

namespace kerfbench::trace {
namespace {

namespace fs = std::filesystem;

std::string bytesOf(const fs::path& path) {
  std::optional<std::string> bytes = base::fileContent(path);
  if (!bytes) throw std::system_error(errno, std::generic_category(), "cannot read " + path.string());
  return *std::move(bytes);
}

}  // namespace

fs::path clipPage(const fs::path& bin_dir) { return base::windowPages(bin_dir) / "clip.html"; }

void writeClipPage(const fs::path& page, const fs::path& trace, const ClipTitle& title, const fs::path& out) {
  std::string html = bytesOf(page);
  const auto fill = [&](std::string_view place, const std::string& text) {
    const auto at = html.find(place);
    if (at == std::string::npos)
      throw base::InputError(fmt::format("{} is no page for a trace: it has no {}", page.string(), place));
    html.replace(at, place.size(), text);
  };
  // The first that occurs is filled first, so that no text is taken for a place.
  fill("{{moment_s}}", title.moment_s ? fmt::format("{:.9f}", *title.moment_s) : std::string());
  fill("{{title}}", report::escapeHtml(title.title));
  fill("{{trace_base64}}", report::base64(bytesOf(trace)));
  base::writeFileAtomically(out, html);
}

}  // namespace kerfbench::trace
