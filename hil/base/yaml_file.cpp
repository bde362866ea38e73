// SPDX-License-Identifier: Apache-2.0
// From files to mappings: how YamlReader is opened.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "hil/base/config_text.h"
#include "hil/base/input_file.h"
#include "hil/base/yaml_node.h"

namespace kerfbench::base {
namespace {

[[noreturn]] void refuseConfig(const std::filesystem::path& path, const std::string& refusal) {
  throw ConfigError(fmt::format("{}: {}", path.string(), refusal));
}

// The mapping in the text of a file.
YAML::Node mappingIn(const std::string& text, const std::filesystem::path& path) {
  if (text.size() > kLargestConfig_bytes)
    refuseConfig(path,
                 fmt::format("has {} bytes, and at most {} are read", text.size(), kLargestConfig_bytes));
  YAML::Node yaml;
  try {
    std::vector<YAML::Node> documents = YAML::LoadAll(text);
    std::erase_if(documents, [](const YAML::Node& document) { return !given(document); });
    if (documents.size() > 1)
      refuseConfig(path, fmt::format("holds {} documents of YAML (behind ---), and one is expected",
                                     documents.size()));
    if (!documents.empty()) yaml = documents.front();
  } catch (const YAML::Exception& e) {
    throw ConfigError(fmt::format("{}:{}: {}", path.string(), e.mark.line + 1, e.msg));
  }
  if (!yaml.IsMap()) throw ConfigError(fmt::format("{}:1: expected 'key: value' lines", path.string()));
  return yaml;
}

// Whatever a scenario extends, somebody else may own and keep from others: its name must be that of settings.
bool isConfigName(const std::filesystem::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

}  // namespace

std::string configText(const std::filesystem::path& path) {
  InputContent content = readInput(path, kLargestConfig_bytes);
  if (!content.bytes) refuseConfig(path, content.refusal);
  return *std::move(content.bytes);
}

YamlReader YamlReader::openFile(const std::filesystem::path& path) { return openChain(path, nullptr); }

YamlReader YamlReader::openText(const std::filesystem::path& path, const std::string& text) {
  return openChain(path, &text);
}

YamlReader YamlReader::openChain(const std::filesystem::path& path, const std::string* text) {
  constexpr int kDeepest = 8;
  auto file = std::make_shared<File>();
  file->path = path;
  // From the file asked for down to the one that extends nothing.
  std::vector<std::pair<std::filesystem::path, YAML::Node>> chain;
  for (std::filesystem::path next = path; !next.empty();) {
    if (chain.size() == kDeepest) {
      throw ConfigError(fmt::format("{}: extends more than {} files deep", path.string(), kDeepest));
    }
    const bool is_given = chain.empty() && text != nullptr;
    chain.emplace_back(next, mappingIn(is_given ? *text : configText(next), next));
    file->depend(next);
    const YAML::Node constant = chain.back().second;
    const YAML::Node extends = constant["extends"];
    if (!given(extends) || !extends.IsScalar()) break;
    next = next.parent_path() / extends.Scalar();
    if (!isConfigName(next))
      refuseConfig(chain.back().first,
                   fmt::format("extends: '{}' is no .yaml file, and no other is read", extends.Scalar()));
  }
  std::shared_ptr<Node> node;
  for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
    node = std::make_shared<Node>(file, it->second, KeyBook{it->first, "", {}, {"extends"}, {}},
                                  std::move(node));
  }
  return YamlReader(std::move(node));
}

bool isYamlValue(const std::string& text) {
  if (text.empty() || text.find_first_of("\n\r") != std::string::npos) return false;
  try {
    const YAML::Node node = YAML::Load(fmt::format("key: {}\n", text));
    return node.IsMap() && node.size() == 1 && node["key"].IsDefined();
  } catch (const YAML::Exception&) {
    return false;
  }
}

}  // namespace kerfbench::base
