// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_job_file.h"

#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::calibrate {
namespace {

/// 1e-9 mm: far below what any machine resolves, and the same on each.
std::string place(const Eigen::Vector2d& p_mm) { return fmt::format("{:.9f}, {:.9f}", p_mm.x(), p_mm.y()); }

std::string singleQuoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

/// All that the digest holds.
std::string body(const MarkJob& job) {
  std::string text = fmt::format(
      "name: {}\n"
      "machine: {}\n"
      "date: '{}'\n"
      "size_mm: {:.9f}            # Of a mark.\n"
      "p_SW_mm: [{}]   # Where the machine's origin lies on the sheet: p_S = p_W + p_SW.\n"
      "print:   # Marks printed on the sheet, in S.\n",
      singleQuoted(job.name), singleQuoted(job.machine), job.date, job.size_mm, place(job.p_SW_mm));
  for (const RegistrationMark& mark : job.print)
    text += fmt::format("  - {{p_S_mm: [{}], diameter_mm: {:.9f}}}\n", place(mark.p_SM_mm), mark.diameter_mm);
  text += "marks:   # Wanted, in W, in order of cutting.\n";
  for (const WantedMark& mark : job.marks)
    text += fmt::format("  - {{number: {}, p_W_mm: [{}]}}\n", mark.number, place(mark.p_W_mm));
  return text;
}

Eigen::Vector2d readPlace(base::YamlReader& section, std::string_view key) {
  const auto p = section.numbers(key, 2, base::YamlReader::Range{});
  return {p[0], p[1]};
}

}  // namespace

std::string markJobDigest(const MarkJob& job) { return base::sha256(body(job)); }

std::string markJobText(const MarkJob& job) {
  return fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Marks to be cut into a sheet, to calibrate a scan head: docs/how-to/calibrate-a-head.md.\n"
      "version: 1\n"
      "digest: '{}'   # Of all that follows: a job is not edited, but planned anew.\n"
      "{}",
      markJobDigest(job), body(job));
}

std::string markJobDxf(const MarkJob& job) {
  std::string text = fmt::format(
      "999\nSPDX-License-Identifier: Apache-2.0\n999\nfield marks, job {}\n"
      "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$MEASUREMENT\n70\n1\n0\nENDSEC\n"
      "0\nSECTION\n2\nENTITIES\n",
      markJobDigest(job));
  for (const dieline::Entity& entity : job.dieline().entities) {
    const auto& line = std::get<dieline::LineCurve>(entity.curve);
    text += fmt::format("0\nLINE\n8\nCUT\n10\n{:.9f}\n20\n{:.9f}\n11\n{:.9f}\n21\n{:.9f}\n",
                        line.start_mm.x(), line.start_mm.y(), line.end_mm.x(), line.end_mm.y());
  }
  return text + "0\nENDSEC\n0\nEOF\n";
}

void writeMarkJob(const std::filesystem::path& path, const MarkJob& job) {
  std::vector<std::string> faults;
  for (const MarkJobFault& fault : job.faults())
    faults.push_back(fmt::format("{}: {}", fault.key, fault.message));
  if (!faults.empty())
    throw std::invalid_argument(fmt::format("{}: {}", path.string(), fmt::join(faults, "; ")));
  std::filesystem::path drawing = path;
  base::writeFileAtomically(drawing.replace_extension(".dxf"), markJobDxf(job));
  base::writeFileAtomically(path, markJobText(job));
}

MarkJob readMarkJob(const std::filesystem::path& path) {
  auto file = base::YamlReader::openFile(path);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  const std::string digest = file.text("digest");
  MarkJob job;
  job.name = file.text("name");
  job.machine = file.text("machine");
  job.date = file.text("date");
  job.size_mm = file.number("size_mm", {});
  job.p_SW_mm = readPlace(file, "p_SW_mm");
  for (base::YamlReader& mark : file.list("print")) {
    const Eigen::Vector2d p_S_mm = readPlace(mark, "p_S_mm");
    job.print.push_back({p_S_mm, mark.number("diameter_mm", {.min = 0.1, .max = 100})});
  }
  std::vector<base::YamlReader> marks = file.list("marks");
  for (base::YamlReader& mark : marks) {
    const auto number = mark.integer("number", {.min = -1e6, .max = 1e6});
    job.marks.push_back({static_cast<int>(number), readPlace(mark, "p_W_mm")});
  }
  const std::vector<MarkJobFault> faults = job.faults();
  for (const MarkJobFault& fault : faults) {
    base::YamlReader& where = fault.mark < 0 ? file : marks.at(static_cast<std::size_t>(fault.mark));
    where.fault(fault.key, fault.message);
  }
  if (faults.empty() && digest != markJobDigest(job))
    file.fault("digest", "does not fit: the file was changed after it was written");
  file.finish();
  return job;
}

}  // namespace kerfbench::calibrate
