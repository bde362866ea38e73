// SPDX-License-Identifier: Apache-2.0
#include "hil/app/trace_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>

#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/trace/run/clip_page.h"
#include "hil/trace/trace_file.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

void sayFault(const std::string& line) { base::toTerminal(stderr, line + "\n"); }
void sayLine(const std::string& line) { base::toTerminal(stdout, line + "\n"); }

/// A browser reads no larger text at once.
constexpr std::uintmax_t kMostInPage_bytes = std::uintmax_t{64} << 20U;

/// What the file itself is to blame for becomes its exit code.
template <class Work>
int onTrace(const fs::path& file, Work work) {
  try {
    return work();
  } catch (const trace::McapError& e) {
    sayFault(fmt::format("trace: {}", e.what()));
  } catch (const base::InputError& e) {
    sayFault(fmt::format("trace: {}", e.what()));
  } catch (const std::system_error& e) {
    std::error_code ignored;  // A loop of links is no file, and no fault of the bench.
    if (fs::exists(file, ignored)) throw;
    sayFault(fmt::format("trace: {}", e.what()));
  }
  return base::kExitInput;
}

void tellInfo(const fs::path& file, const trace::TraceInfo& info) {
  sayLine(fmt::format("{}: {} bytes, {} chunks, {:.6f} … {:.6f} s, by {}", file.string(), info.bytes,
                      info.chunks, info.first_s, info.last_s, info.library));
  for (const auto& [name, values] : info.metadata)
    for (const auto& [key, value] : values) sayLine(fmt::format("  {}.{}: {}", name, key, value));
  for (const trace::TraceInfo::TopicCount& topic : info.topics)
    sayLine(fmt::format("  {:<16} {:>9} messages {:>12} bytes  {}", topic.topic, topic.messages, topic.bytes,
                        topic.schema));
  if (!info.attachments.empty()) sayLine(fmt::format("  attachments: {}", fmt::join(info.attachments, ", ")));
}

int tellCopied(const trace::Copied& copied, const fs::path& out) {
  for (const std::string& problem : copied.problems) sayFault(fmt::format("left out, {}", problem));
  sayLine(fmt::format("{}: {} messages", out.string(), copied.messages));
  return 0;
}

}  // namespace

int traceInfoCommand(const fs::path& file) {
  return onTrace(file, [&] {
    const trace::TraceInfo info = trace::traceInfo(file);
    tellInfo(file, info);
    for (const std::string& problem : info.problems) sayLine("  damaged, " + problem);
    if (info.cut_off_bytes > 0)
      sayLine(fmt::format("  cut off: its last {} bytes are no whole record", info.cut_off_bytes));
    if (!info.whole) sayLine("  without its end: the run goes on, or was killed (kerfbench trace recover)");
    return info.whole && info.problems.empty() ? 0 : 1;
  });
}

int traceRecoverCommand(const TraceRecovery& options) {
  return onTrace(options.file,
                 [&] { return tellCopied(trace::rewriteTrace(options.file, options.out), options.out); });
}

int traceClipCommand(const TraceClip& options) {
  return onTrace(options.file, [&] {
    const trace::TraceSpan span{std::max(0.0, options.at_s - options.around_s),
                                options.at_s + options.around_s};
    const trace::TraceInfo info = trace::traceInfo(options.file);
    if (span.from_s > info.last_s)
      throw base::InputError(fmt::format("{} ends at {:.6f} s", options.file.string(), info.last_s));
    return tellCopied(trace::rewriteTrace(options.file, options.out, span), options.out);
  });
}

int tracePageCommand(const TracePage& options) {
  const fs::path page = trace::clipPage(options.bin_dir);
  if (!fs::exists(page)) {
    sayFault(fmt::format("trace: {} is not there: the window is built by ./bench serve", page.string()));
    return base::kExitBroken;
  }
  return onTrace(options.file, [&] {
    const auto run = trace::runMetadata(options.file);
    if (fs::file_size(options.file) > kMostInPage_bytes)
      throw base::InputError(fmt::format("{} is too large for a page; take a part (kerfbench trace clip)",
                                         options.file.string()));
    const auto scenario = run.find("scenario");
    trace::writeClipPage(page, options.file, {scenario == run.end() ? "" : scenario->second, options.at_s},
                         options.out);
    sayLine(options.out.string());
    return 0;
  });
}

}  // namespace kerfbench::app
