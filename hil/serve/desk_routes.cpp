// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/desk_routes.h"

#include <fmt/format.h>

#include <cctype>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "hil/base/file_content.h"
#include "hil/desk/first_scenario.h"
#include "hil/desk/hand_order.h"
#include "hil/desk/job_plan.h"
#include "hil/desk/place_anew.h"
#include "hil/desk/reference_keys.h"
#include "hil/desk/scenario_check.h"
#include "hil/desk/scenario_copy.h"
#include "hil/desk/scenario_edit.h"
#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string textOf(const Json& json, const char* key) {
  if (!json.contains(key) || !json[key].is_string())
    throw Refusal(400, fmt::format("The request has no text '{}'.", key));
  return json[key].get<std::string>();
}

/// A scenario in the editor. One that has no name yet is as good as in the folder.
desk::ScenarioText scenarioIn(const Json& json, const WorkFolder& files) {
  const std::string name = json.value("path", "");
  return {textOf(json, "scenario_text"), files.placeOf(name.empty() ? "new.yaml" : name)};
}

desk::DeskRequest requestOf(const WorkFolder& files, const fs::path& bin_dir) {
  desk::DeskRequest request;
  request.bin_dir = bin_dir;
  request.name_of = [&files](const fs::path& path) {
    std::string name = files.nameOf(path);
    return name.empty() ? path.string() : name;
  };
  return request;
}

/// Entities by their numbers. @throws Refusal 400 for anything else.
std::vector<int> orderIn(const Json& json) {
  std::vector<int> order;
  const bool is_list = json.contains("order") && json["order"].is_array();
  if (is_list) {
    for (const Json& id : json["order"]) {
      if (!id.is_number_integer()) throw Refusal(400, "'order' is a list of entities' numbers.");
      order.push_back(id.get<int>());
    }
    return order;
  }
  throw Refusal(400, "The request has no list 'order'.");
}

/// A name that may be written, from one that somebody gave.
std::string writableFrom(const std::string& wanted) {
  std::string name;
  for (const char c : wanted) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    name += is_plain ? c : '-';
  }
  const std::size_t first = name.find_first_not_of('-');
  return first == std::string::npos ? "job" : name.substr(first);
}

/// Gives its place back with the scope.
class Place {
 public:
  explicit Place(std::counting_semaphore<DeskRoutes::kAtOnce>& places) : places_(places) {
    places_.acquire();
  }
  ~Place() { places_.release(); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

 private:
  std::counting_semaphore<DeskRoutes::kAtOnce>& places_;
};

}  // namespace

Answer DeskRoutes::byDesk(const std::function<std::string()>& work) {
  const Place place(places_);
  Answer answer;
  try {
    answer.text = work() + "\n";
  } catch (const Refusal&) {
    throw;
  } catch (const std::system_error&) {
    throw;  // Not the user's: a disk that cannot be read, say.
  } catch (const std::runtime_error& fault) {
    throw Refusal(400, fault.what());
  }
  return answer;
}

Answer DeskRoutes::reference(const Asked& asked) {
  const std::string& page = asked.wanted("page");
  return byDesk([&] { return desk::referenceJson(page, bin_dir_); });
}

Answer DeskRoutes::check(const Asked& asked) {
  const desk::ScenarioText scenario = scenarioIn(asked.json(), files_);
  return byDesk([&] { return desk::checkJson(scenario, requestOf(files_, bin_dir_)); });
}

Answer DeskRoutes::edit(const Asked& asked) {
  const std::string body = asked.body();
  return byDesk([&] { return desk::editJson(body); });
}

Answer DeskRoutes::plan(const Asked& asked) {
  const Json json = asked.json();
  const desk::ScenarioText scenario = scenarioIn(json, files_);
  std::optional<std::string> gcode;
  if (json.contains("gcode") && !json["gcode"].is_null()) gcode = textOf(json, "gcode");
  return byDesk([&] { return desk::planJson(scenario, gcode, requestOf(files_, bin_dir_)); });
}

Answer DeskRoutes::order(const Asked& asked) {
  const Json json = asked.json();
  const desk::ScenarioText scenario = scenarioIn(json, files_);
  const std::vector<int> order = orderIn(json);
  return byDesk([&] { return desk::orderJson(scenario, order, requestOf(files_, bin_dir_)); });
}

Answer DeskRoutes::place(const Asked& asked) {
  const Json json = asked.json();
  const desk::ScenarioText scenario = scenarioIn(json, files_);
  std::optional<std::string> unit;
  if (json.contains("unit") && !json["unit"].is_null()) unit = textOf(json, "unit");
  return byDesk([&] { return desk::placeJson(scenario, unit, requestOf(files_, bin_dir_)); });
}

void DeskRoutes::refuseUncuttable(const fs::path& file, const std::string& name) {
  try {
    (void)byDesk([&] {
      desk::refuseUncuttable(file, requestOf(files_, bin_dir_));
      return std::string();
    });
  } catch (const Refusal& refusal) {
    // The file lies elsewhere while it is looked at.
    std::string words = refusal.what();
    for (auto at = words.find(file.string()); at != std::string::npos; at = words.find(file.string(), at))
      words.replace(at, file.string().size(), name);
    throw Refusal(refusal.status(), words);
  }
}

std::string DeskRoutes::freeName(const std::string& folder, const std::string& wanted) const {
  constexpr int kMostTries = 1000;
  const std::string name = folder + writableFrom(wanted);
  for (int i = 1; i < kMostTries; ++i) {
    std::string free = i == 1 ? name + ".yaml" : fmt::format("{}-{}.yaml", name, i);
    std::error_code error;
    if (!fs::exists(fs::symlink_status(files_.placeOf(free), error))) return free;
  }
  throw Refusal(400, fmt::format("'{}' and all names like it are taken.", name));
}

Answer DeskRoutes::create(const Asked& asked) {
  constexpr const char* kUsualMachine = "shipped/machines/two-mirror.yaml";
  const Json json = asked.json();
  const bool is_copy = json.contains("from");
  const std::string source = textOf(json, is_copy ? "from" : "drawing");
  const fs::path file = files_.pathOf(source);
  const bool is_shipped = source.starts_with(kShipped);
  const std::string folder = is_shipped ? "" : source.substr(0, source.rfind('/') + 1);
  const std::string path =
      freeName(folder, json.contains("name") ? textOf(json, "name") : file.stem().string());
  const fs::path place = files_.placeOf(path);
  std::string text;
  Answer answer = byDesk([&] {
    const desk::DeskRequest request = requestOf(files_, bin_dir_);
    if (is_copy) {
      text = json.contains("text") ? textOf(json, "text") : base::fileContent(file).value_or("");
      text = desk::copiedScenario({text, file}, place, request);
    } else {
      const std::string machine = json.contains("machine") ? textOf(json, "machine") : kUsualMachine;
      text = desk::firstScenario({file, files_.pathOf(machine), place}, request);
    }
    return Json{{"path", path}, {"text", text}}.dump(-1, ' ', false, Json::error_handler_t::replace);
  });
  files_.write(path, [&text](const std::function<void(std::string_view)>& take) { take(text); });
  return answer;
}

}  // namespace kerfbench::serve
