// SPDX-License-Identifier: Apache-2.0
#include "hil/witness/witness.h"

#include <fmt/format.h>

#include <optional>
#include <system_error>

#include "hil/base/exit_codes.h"
#include "hil/base/text.h"
#include "hil/dieline/file_format.h"
#include "hil/dieline/read.h"
#include "hil/witness/compare.h"

namespace kerfbench::witness {
namespace {

namespace fs = std::filesystem;

using dieline::FileFormat;

/// As the script calls it; empty for what nobody else reads.
std::string formatName(const fs::path& drawing) {
  const auto format = dieline::fileFormatOf(drawing);
  if (format == FileFormat::kDxf) return "dxf";
  if (format == FileFormat::kSvg) return "svg";
  return format == FileFormat::kPdf ? "pdf" : "";
}

/// A number that a reader of decimals takes for the very same.
std::string exact(double value) { return fmt::format("{:.17g}", value); }

std::vector<std::string> commandFor(const dieline::Dieline& dieline, const dieline::DrawingOptions& options,
                                    const WitnessProgram& program) {
  // -I: nothing of the user's environment or folders; -B: no files are written beside the script.
  std::vector<std::string> command{program.python.string(), "-I", "-B", program.script.string()};
  command.push_back("--format=" + formatName(dieline.path));
  if (options.unit) command.push_back("--unit-mm=" + exact(dieline::millimetresOf(*options.unit)));
  if (options.page) command.push_back(fmt::format("--page={}", *options.page));
  command.push_back("--scale=" + exact(options.scale));
  command.push_back("--turn=" + exact(options.turn_deg));
  command.push_back("--shift-x=" + exact(options.shift_mm.x()));
  command.push_back("--shift-y=" + exact(options.shift_mm.y()));
  command.emplace_back("--");
  command.push_back(fs::absolute(dieline.path).string());
  return command;
}

/// The reading with the lines that were left out because they repeat others: the second reader has them all.
dieline::Dieline wholeReading(const dieline::Dieline& dieline, dieline::DrawingOptions options) {
  if (!options.once) return dieline;
  options.once = false;
  return dieline::readDieline(dieline.path, options);
}

Testimony broken(const std::string& sentence) { return {Testimony::Kind::kBroken, {sentence}}; }

Testimony agreement(const SecondReading& second, const Comparison& compared, FileFormat format) {
  const Tolerance tolerance = toleranceFor(format);
  const char* const more = format == FileFormat::kPdf ? "what single precision rounds off" : "1e-9 of it";
  std::string sentence = fmt::format(
      "the second reader ({}) agrees on {} layer{}, {:.3f} mm in all: lengths to {:.4f} um (allowed: {:g} um "
      "and {}), "
      "boxes to {:.4f} um (allowed: {:g} um)",
      base::printable(second.reader), compared.layers, compared.layers == 1 ? "" : "s", compared.length_mm,
      1e3 * compared.worst_length_mm, 1e3 * tolerance.length_mm, more, 1e3 * compared.worst_box_mm,
      1e3 * tolerance.box_mm);
  return {Testimony::Kind::kAgrees, {std::move(sentence)}};
}

Testimony parting(const SecondReading& second, const Comparison& compared) {
  Testimony testimony{Testimony::Kind::kParts, {}};
  constexpr std::size_t kTold = 20;
  for (const std::string& sentence : compared.partings) {
    if (testimony.sentences.size() == kTold) break;
    testimony.sentences.push_back(sentence);
  }
  testimony.sentences.push_back(
      fmt::format("the second reader ({}) parts from this one in {} {}; nothing says which is right: look at "
                  "these layers in "
                  "the program that made the drawing and with `kerfbench show`, and draw what differs as "
                  "plain lines, arcs or "
                  "paths",
                  base::printable(second.reader), compared.partings.size(),
                  compared.partings.size() == 1 ? "place" : "places"));
  return testimony;
}

/// Why there is no answer before anybody is asked.
std::optional<Testimony> unasked(const fs::path& drawing, const WitnessProgram& program) {
  if (!hasWitness(drawing)) {
    return Testimony{
        Testimony::Kind::kParts,
        {fmt::format("there is no second reader for {}: nobody else's library reads it, so nothing "
                     "witnesses this reading; leave out the demand, or save the drawing as DXF",
                     base::inQuotes(drawing.extension().string()))}};
  }
  std::error_code ignored;
  if (!fs::exists(program.python, ignored)) {
    return Testimony{Testimony::Kind::kMissing,
                     {fmt::format("the second reader needs {}: install it (apt-get install python3)",
                                  program.python.string())}};
  }
  if (!fs::exists(program.script, ignored)) {
    return Testimony{
        Testimony::Kind::kMissing,
        {fmt::format("the second reader's script {} is not there: build the bench again (./bench setup)",
                     program.script.string())}};
  }
  return std::nullopt;
}

}  // namespace

WitnessProgram witnessBeside(const fs::path& bin_dir) {
  WitnessProgram program;
  program.script = bin_dir.parent_path() / "witness" / "second_reader.py";
  return program;
}

bool hasWitness(const fs::path& drawing) { return !formatName(drawing).empty(); }

Testimony testimonyOf(const dieline::Dieline& dieline, const dieline::DrawingOptions& options,
                      const WitnessProgram& program) {
  if (auto without = unasked(dieline.path, program)) return *without;
  const BoundedOutput run = runBounded(commandFor(dieline, options, program), program.limits);
  if (!run.could_start)
    return {Testimony::Kind::kMissing,
            {fmt::format("the second reader's {} {}", program.python.string(), run.trouble)}};
  if (!run.trouble.empty())
    return broken(fmt::format("the second reader {}; it witnesses nothing", run.trouble));
  SecondReading second;
  try {
    second = secondReadingFrom(run.output);
  } catch (const NoReading& error) {
    return broken(fmt::format("the second reader's answer {}; it witnesses nothing", error.what()));
  }
  if (!second.missing.empty()) {
    const std::string package = base::printable(second.missing);
    return {
        Testimony::Kind::kMissing,
        {fmt::format("the second reader needs the package {0}: install it (apt-get install {0})", package)}};
  }
  if (!second.refused.empty()) {
    return {
        Testimony::Kind::kParts,
        {fmt::format("the second reader cannot read the drawing, so that nothing witnesses this reading: {}",
                     base::printable(second.refused, 300))}};
  }
  const FileFormat format = *dieline::fileFormatOf(dieline.path);
  const Comparison compared = compareReadings(wholeReading(dieline, options), second, options, format);
  return compared.partings.empty() ? agreement(second, compared, format) : parting(second, compared);
}

int exitCodeOf(Testimony::Kind kind) {
  switch (kind) {
    case Testimony::Kind::kAgrees:
      return 0;
    case Testimony::Kind::kParts:
      return base::kExitInput;
    case Testimony::Kind::kMissing:
    case Testimony::Kind::kBroken:
      return base::kExitBroken;
  }
  return base::kExitBroken;
}

}  // namespace kerfbench::witness
