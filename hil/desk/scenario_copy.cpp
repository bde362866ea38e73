// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/scenario_copy.h"

#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/desk/file_name.h"
#include "hil/desk/reference_keys.h"
#include "hil/desk/scenario_edit.h"
#include "hil/desk/yaml_layout.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Keys that name a file or a folder, as the reference says.
std::set<std::string> fileKeys(const fs::path& bin_dir) {
  const fs::path page = referencePage("scenario", bin_dir);
  const auto text = base::fileContent(page);
  if (!text) throw base::InputError("cannot read " + page.string());
  std::set<std::string> keys;
  for (const ReferenceSection& section : referenceSections(*text)) {
    for (const ReferenceKey& key : section.keys)
      if (key.range.kind == KeyKind::kFile || key.range.or_file)
        keys.insert(section.prefixes.front() + key.key);
  }
  return keys;
}

/// The values of a tree at keys that name files.
void collectFiles(const ordered_json& section, const std::string& prefix, const std::set<std::string>& keys,
                  std::vector<std::string>& path, std::vector<KeyEdit>& found) {
  for (const auto& [key, value] : section.items()) {
    path.push_back(key);
    if (value.is_object()) collectFiles(value, prefix + key + ".", keys, path, found);
    if (value.is_string() && keys.contains(prefix + key)) found.push_back({path, value});
    path.pop_back();
  }
}

}  // namespace

std::string copiedScenario(const ScenarioText& scenario, const fs::path& to, const DeskRequest& request) {
  std::vector<KeyEdit> edits;
  std::vector<std::string> path;
  const ordered_json tree = valueOf(layoutOf(scenario.text));
  collectFiles(tree, "", fileKeys(request.bin_dir), path, edits);
  const fs::path from_folder = scenario.file.parent_path();
  const fs::path to_folder = to.parent_path().lexically_normal();
  // What lies not beside the scenario is looked for elsewhere: a release of the bench, a name in a library.
  std::erase_if(edits, [&](KeyEdit& edit) {
    const fs::path file = edit.value.get<std::string>();
    const fs::path whole = (from_folder / file).lexically_normal();
    std::error_code error;
    if (file.is_absolute() || !fs::exists(whole, error)) return true;
    edit.value = nameFromFolder(whole, to_folder);
    return false;
  });
  if (tree.is_object() && tree.contains("name")) edits.push_back({{"name"}, to.stem().string()});
  return edited(scenario.text, edits);
}

}  // namespace kerfbench::desk
