// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/answer.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

constexpr int kDeepestJson = 32;

}  // namespace

const std::string& Asked::wanted(const std::string& name) const {
  const auto found = head.query.find(name);
  if (found == head.query.end() || found->second.empty())
    throw Refusal(400, fmt::format("The request does not say '{}'.", name));
  return found->second;
}

std::string Asked::body() const {
  std::string whole;
  whole.reserve(head.body_bytes);
  const bool is_whole = read_body([&whole](std::string_view piece) {
    whole += piece;
    return true;
  });
  if (!is_whole || whole.size() != head.body_bytes)
    throw Refusal(400, "The body of the request did not come as a whole.");
  return whole;
}

nlohmann::json Asked::json() const {
  // A nest costs a hundred times its bytes.
  const auto is_flat = [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    if (depth > kDeepestJson) throw Refusal(400, "The JSON of the request is nested too deep.");
    return true;
  };
  nlohmann::json parsed = nlohmann::json::parse(body(), is_flat, false);
  if (!parsed.is_object()) throw Refusal(400, "The body of the request is no JSON object.");
  return parsed;
}

Answer jsonAnswer(const nlohmann::json& json) {
  Answer answer;
  answer.text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  return answer;
}

Answer errorAnswer(int status, const std::string& sentence) {
  Answer answer = jsonAnswer({{"error", sentence}});
  answer.status = status;
  return answer;
}

std::string typeOf(const std::string& name) {
  static const std::map<std::string, std::string> kTypes{{".html", "text/html; charset=utf-8"},
                                                         {".js", "text/javascript; charset=utf-8"},
                                                         {".css", "text/css; charset=utf-8"},
                                                         {".json", "application/json"},
                                                         {".svg", "image/svg+xml"},
                                                         {".png", "image/png"},
                                                         {".jpg", "image/jpeg"},
                                                         {".jpeg", "image/jpeg"},
                                                         {".webm", "video/webm"},
                                                         {".xml", "text/xml; charset=utf-8"},
                                                         {".txt", "text/plain; charset=utf-8"},
                                                         {".yaml", "text/plain; charset=utf-8"},
                                                         {".csv", "text/plain; charset=utf-8"},
                                                         {".gcode", "text/plain; charset=utf-8"},
                                                         {".vcd", "text/plain; charset=utf-8"},
                                                         {".pdf", "application/pdf"}};
  const auto found = kTypes.find(std::filesystem::path(name).extension().string());
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

}  // namespace kerfbench::serve
