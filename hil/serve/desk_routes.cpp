// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/desk_routes.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "hil/desk/reference_keys.h"
#include "hil/desk/scenario_check.h"
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
  const std::string body = asked.json().dump();
  return byDesk([&] { return desk::editJson(body); });
}

}  // namespace kerfbench::serve
