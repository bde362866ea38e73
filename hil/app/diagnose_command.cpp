// SPDX-License-Identifier: Apache-2.0
#include "hil/app/diagnose_command.h"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/cli/run_guarded.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/evidence_json.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

std::string asJson(const fs::path& file, const diagnose::Diagnosis& diagnosis) {
  nlohmann::ordered_json json{{"file", file.string()}, {"sentence", diagnosis.sentence}};
  json["causes"] = nlohmann::ordered_json::array();
  for (const diagnose::Cause& cause : diagnosis.causes)
    json["causes"].push_back({{"cause", cause.key},
                              {"size", cause.size.value},
                              {"expanded_uncertainty", cause.size.U},
                              {"unit", cause.size.unit},
                              {"share_explained", std::isfinite(cause.share) ? cause.share : -1.0},
                              {"direct", cause.direct},
                              {"gain", cause.score},
                              {"not_told_from", cause.instead},
                              {"sentence", cause.sentence}});
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

int diagnoseOne(const fs::path& file, bool as_json, base::Console& console) {
  const std::optional<std::string> text = base::fileContent(file);
  if (!text) throw base::InputError(file.string() + " cannot be read");
  diagnose::Diagnosis diagnosis;
  try {
    diagnosis = diagnose::diagnose(diagnose::evidenceFromJson(*text));
  } catch (const std::runtime_error& e) {
    throw base::InputError(file.string() + ": " + e.what());
  }
  if (as_json) {
    console.result(base::jsonForTerminal(asJson(file, diagnosis)));
    return 0;
  }
  const bool is_explained = !diagnosis.causes.empty() && diagnose::explainsMost(diagnosis.causes.front());
  if (!is_explained)
    console.result(diagnosis.sentence.empty()
                       ? "The run has passed, or nothing stands out: no cause is named."
                       : diagnosis.sentence);
  for (const diagnose::Cause& cause : diagnosis.causes) console.result(cause.sentence);
  return 0;
}

}  // namespace

int diagnoseCommand(const std::vector<fs::path>& files, bool as_json) {
  base::Console console(false);
  int code = 0;
  for (const fs::path& file : files)
    code =
        base::worstExitCode(code, cli::runGuarded(file, [&] { return diagnoseOne(file, as_json, console); }));
  return code;
}

}  // namespace kerfbench::app
