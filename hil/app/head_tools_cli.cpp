// SPDX-License-Identifier: Apache-2.0
#include "hil/app/head_tools_cli.h"

#include <string>
#include <vector>

namespace kerfbench::hil {
namespace {

const std::vector<std::string> kTableFormats{"csv", "c-header", "cor1", "cor2", "grid-text", "nine-points"};

/// "33x17"
void readNodes(const std::string& text, TableCommandOptions& options) {
  const auto cross = text.find('x');
  const auto number = [](const std::string& digits) {
    const bool plain =
        !digits.empty() && digits.size() <= 4 && digits.find_first_not_of("0123456789") == std::string::npos;
    return plain ? std::stoi(digits) : 0;
  };
  options.columns = cross == std::string::npos ? 0 : number(text.substr(0, cross));
  options.rows = cross == std::string::npos ? 0 : number(text.substr(cross + 1));
  const auto good = [](int count) { return count >= 2 && count <= 1025; };
  if (!good(options.columns) || !good(options.rows))
    throw CLI::ValidationError("--nodes", "is to be COLUMNSxROWS, 2 to 1025 each");
}

}  // namespace

HeadToolsCli::HeadToolsCli(CLI::App& calibrate) { addTable(calibrate); }

void HeadToolsCli::addTable(CLI::App& calibrate) {
  TableCommandOptions& o = table_;
  CLI::App* table = calibrate.add_subcommand(
      "table",
      "Tell what a file of correction is, hold it against nine marks, write it in another format.\n"
      "docs/CORRECTION-FILES.md has the formats and their conventions. Exit code 0; with --check 1: not to "
      "be\n"
      "used as it is, 4: the marks cannot tell; nothing is written then. 65: bad input.");
  table->add_option("FILE", o.file, "Table")->required();
  table->add_option("--format", o.format, "Of FILE; otherwise by its content")
      ->check(CLI::IsMember(kTableFormats));
  CLI::Option* check = table->add_option("--check", o.check,
                                         "Nine points as measured without any correction (ix iy x_wrong_mm "
                                         "y_wrong_mm): which way round is the table?");
  table->add_option("--sigma-mm", o.sigma_mm, "Standard deviation of a coordinate of --check")
      ->needs(check)
      ->check(CLI::Range(1e-5, 1.0))
      ->capture_default_str();
  CLI::Option* out = table->add_option("--out", o.out, "Write the table there, righted if --check says so");
  table->add_option("--to", o.to, "Format of --out")
      ->needs(out)
      ->check(CLI::IsMember(kTableFormats))
      ->capture_default_str();
  table
      ->add_option_function<std::string>(
          "--nodes", [&o](const std::string& text) { readNodes(text, o); },
          "Of --out, as COLUMNSxROWS; otherwise those of the table, or of its format")
      ->type_name("CxR")
      ->needs(out);
  table->add_option("--cor", o.cor, "Whose convention a .cor follows, read or written")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(kCorConventions), std::end(kCorConventions))))
      ->capture_default_str();
  table
      ->add_option(
          "--units-per-mm", o.units_per_mm,
          "Of a .cor; otherwise read: the file's, written: 64 cells over the largest square in the table")
      ->check(CLI::PositiveNumber);
  table->add_option("--mm-per-index", o.mm_per_index, "Of nine points; otherwise the file's, or 2.5")
      ->check(CLI::PositiveNumber);
  table->add_flag("--int32", o.wide, "C header: values of 32 bits, in nm");
  table->add_option("--prefix", o.prefix, "C header: begin of all names")->capture_default_str();
  table->add_flag("--quiet,-q", o.quiet, "Only what was found and written");
  table_command_ = table;
}

std::optional<int> HeadToolsCli::run() const {
  if (table_command_->parsed()) return calibrateTableCommand(table_);
  return std::nullopt;
}

}  // namespace kerfbench::hil
