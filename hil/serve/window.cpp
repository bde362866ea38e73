// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/window.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/version.h"
#include "hil/serve/file_body.h"
#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Addresses within the one page, which looks at them itself.
constexpr std::array kPages{"/", "/view", "/live", "/service", "/station"};
/// The newest runs are what a station shows.
constexpr std::ptrdiff_t kMostStationRuns = 12;
constexpr std::string_view kBundle{"/window/"}, kResults{"/results/"}, kRuns{"/api/runs/"};

bool isPage(const std::string& path) { return std::ranges::find(kPages, path) != kPages.end(); }

/// What anybody may read who reaches the server: pages and scripts, which hold nothing of the user's.
bool isPublic(const HttpHead& head) {
  const bool reads = head.method == "GET" || head.method == "HEAD";
  return reads && (isPage(head.path) || head.path.starts_with(kBundle) || head.path == "/favicon.ico");
}

std::string pagePolicy(const std::string& nonce) {
  return fmt::format(
      "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{}'; img-src 'self' data: blob:; "
      "connect-src 'self'; worker-src 'self' blob:; frame-src 'self'; font-src 'self'; base-uri 'none'; "
      "form-action 'none'; frame-ancestors 'none'",
      nonce);
}

/// A report has its own scripts and styles in it. It runs apart from the window: as if of another server,
/// without its cookie.
constexpr const char* kResultsPolicy =
    "sandbox allow-scripts allow-popups allow-popups-to-escape-sandbox allow-downloads "
    "allow-top-navigation-by-user-activation; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src 'self' data:; media-src 'self' data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'self'";

Answer redirection(const std::string& to) {
  Answer answer;
  answer.status = 303;
  answer.type = "text/plain; charset=utf-8";
  answer.headers.emplace_back("Location", to);
  return answer;
}

std::string withNonce(std::string html, const std::string& nonce) {
  constexpr std::string_view kPlace{"{{nonce}}"};
  for (auto at = html.find(kPlace); at != std::string::npos; at = html.find(kPlace, at))
    html.replace(at, kPlace.size(), nonce);
  return html;
}

std::uint64_t numberOr0(const std::string* text) {
  std::uint64_t number = 0;
  if (text != nullptr) std::from_chars(text->data(), text->data() + text->size(), number);
  return number;
}

/// Counts a stream as long as it lives.
class CountedBody final : public AnswerBody {
 public:
  CountedBody(std::unique_ptr<AnswerBody> body, std::shared_ptr<std::atomic<int>> count)
      : body_(std::move(body)), count_(std::move(count)) {}
  ~CountedBody() override { --*count_; }
  CountedBody(const CountedBody&) = delete;
  CountedBody& operator=(const CountedBody&) = delete;
  std::optional<std::string> next(const std::function<bool()>& is_gone) override {
    return body_->next(is_gone);
  }

 private:
  std::unique_ptr<AnswerBody> body_;
  std::shared_ptr<std::atomic<int>> count_;
};

}  // namespace

Window::Window(WindowSetup setup, ServerAddress address, std::function<void(const std::string&)> token_made)
    : setup_(std::move(setup)),
      access_(std::move(address), std::move(token_made)),
      files_(setup_.folder, setup_.shipped),
      list_(files_),
      runs_(files_, setup_.bin_dir / "kerfbench"),
      desk_(files_, setup_.bin_dir),
      arrivals_(files_, desk_),
      neighbours_(setup_.benches),
      http_([this](const Asked& asked) { return answer(asked); }) {
  if (!fs::exists(setup_.pages / "index.html"))
    throw base::InputError(
        fmt::format("the window's pages are not in {}: ./bench serve makes them", setup_.pages.string()));
}

const std::vector<Window::Route>& Window::routes() {
  static const std::vector<Route> kRoutes{
      {"GET", "/api/session", &Window::session},      {"GET", "/api/files", &Window::listFiles},
      {"PUT", "/api/files", &Window::putFile},        {"GET", "/api/files/content", &Window::fileContent},
      {"PUT", "/api/scenario", &Window::putScenario}, {"POST", "/api/runs", &Window::addRun},
      {"GET", "/api/runs", &Window::listRuns},        {"GET", "/api/trace", &Window::traceFile},
      {"GET", "/api/reference", &Window::reference},  {"POST", "/api/check", &Window::check},
      {"POST", "/api/edit", &Window::edit},           {"GET", "/api/service", &Window::service},
      {"POST", "/api/plan", &Window::plan},           {"POST", "/api/order", &Window::order},
      {"POST", "/api/new", &Window::create},          {"GET", "/api/station", &Window::station},
      {"GET", "/api/benches", &Window::benches},      {"POST", "/api/place", &Window::place},
  };
  return kRoutes;
}

bool Window::admit(const HttpHead& head) {
  access_.checkOrigin(head);
  const bool is_known = access_.isKnown(head);
  if (!isPublic(head) && !head.path.starts_with(kResults)) access_.checkMay(head);
  const std::uint64_t most = head.path == "/api/files" ? kMostFileBytes : kMostJsonBytes;
  if (head.body_bytes > most)
    throw Refusal(413, fmt::format("That is too much: at most {} MiB are taken.", most >> 20U));
  return is_known;
}

bool Window::serve(Connection& connection, const HttpHead& head, bool is_known) {
  return http_.serve(connection, head, is_known);
}

void Window::stop() { http_.stop(); }

Answer Window::answer(const Asked& asked) {
  Answer answer;
  try {
    if (asked.head.path.starts_with(kResults))
      answer = results(asked);
    else if (asked.head.path.starts_with(kBundle))
      answer = bundled(asked);
    else if (isPage(asked.head.path))
      answer = page(asked);
    else
      answer = answerApi(asked);
  } catch (const Refusal& refusal) {
    answer = errorAnswer(refusal.status(), refusal.what());
  }
  answer.headers.emplace_back("X-Content-Type-Options", "nosniff");
  answer.headers.emplace_back("Referrer-Policy", "no-referrer");
  answer.headers.emplace_back("Cross-Origin-Opener-Policy", "same-origin");
  const auto has = [&answer](const char* name) {
    return std::ranges::any_of(answer.headers, [name](const auto& header) { return header.first == name; });
  };
  if (!has("Cache-Control")) answer.headers.emplace_back("Cache-Control", "no-store");
  if (!has("Content-Security-Policy"))
    answer.headers.emplace_back("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
  if (!has("Cross-Origin-Resource-Policy"))
    answer.headers.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
  return answer;
}

Answer Window::answerApi(const Asked& asked) {
  const std::string method = asked.head.method == "HEAD" ? "GET" : asked.head.method;
  bool is_path = false;
  for (const Route& route : routes()) {
    if (route.path != asked.head.path) continue;
    is_path = true;
    if (route.method == method) return (this->*route.answer)(asked);
  }
  if (is_path) throw Refusal(405, "That is not asked in this way.");
  if (asked.head.path.starts_with(kRuns)) return answerRun(asked);
  throw Refusal(404, "There is nothing at this address.");
}

Answer Window::page(const Asked& asked) {
  const auto token = asked.head.query.find("token");
  if (token != asked.head.query.end()) {
    const std::optional<std::string> cookie = access_.sessionFor(token->second);
    // Who has a session already has come by a link that he used before.
    if (!cookie && !asked.is_known)
      throw Refusal(
          403,
          "This address was used before, or is not complete. kerfbench serve prints a new one each time.");
    std::string query;
    for (const auto& [name, value] : asked.head.query) {
      if (name == "token") continue;
      query += (query.empty() ? "?" : "&") + percentEncoded(name) + "=" + percentEncoded(value);
    }
    Answer answer = redirection(asked.head.path + query);
    if (cookie) answer.headers.emplace_back("Set-Cookie", *cookie);
    return answer;
  }
  const std::optional<std::string> html = base::fileContent(setup_.pages / "index.html");
  if (!html) throw Refusal(500, "The window's pages are gone. Start kerfbench serve anew.");
  const std::string nonce = randomWord();
  Answer answer;
  answer.type = "text/html; charset=utf-8";
  answer.headers.emplace_back("Content-Security-Policy", pagePolicy(nonce));
  answer.text = withNonce(*html, nonce);
  return answer;
}

Answer Window::bundled(const Asked& asked) {
  const std::string name = asked.head.path.substr(kBundle.size());
  if (!isReadableName(name) || name.find('/') != std::string::npos || name.ends_with(".html"))
    throw Refusal(404, "There is nothing at this address.");
  base::UniqueFd file(::open((setup_.pages / name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file.valid()) throw Refusal(404, "There is nothing at this address.");
  return fileAnswer(std::move(file), name, asked.head);
}

Answer Window::results(const Asked& asked) {
  std::string rest = asked.head.path.substr(kResults.size());
  const std::string key = rest.starts_with('~') ? rest.substr(1, rest.find('/') - 1) : "";
  if (key.empty()) {
    if (!asked.is_known) throw Refusal(401, "This browser has not been let in.");
    return redirection(fmt::format("/results/~{}/{}", access_.resultsKey(), percentEncoded(rest)));
  }
  if (!access_.isResultsKey(key)) throw Refusal(403, "This address was of an earlier kerfbench serve.");
  rest.erase(0, std::min(key.size() + 2, rest.size()));
  Answer answer = fileAnswer(files_.open("results/" + rest), rest, asked.head);
  answer.headers.emplace_back("Content-Security-Policy", kResultsPolicy);
  // The page is as of another server, and so are its pictures to it.
  answer.headers.emplace_back("Cross-Origin-Resource-Policy", "cross-origin");
  return answer;
}

Answer Window::session(const Asked&) {
  Json addresses = Json::array();
  for (const BenchAddress& bench : setup_.benches)
    addresses.push_back("http://" + hostAndPort({bench.host, bench.port}) + "/");
  return jsonAnswer({{"version", base::version()},
                     {"folder", files_.folder().string()},
                     {"shipped", files_.shipped().fixtures.string()},
                     {"machines_folder", std::string(kShipped) + "machines"},
                     {"can_run", ::access((setup_.bin_dir / "kerfbench").c_str(), X_OK) == 0},
                     {"benches", addresses}});
}

Answer Window::listFiles(const Asked&) { return jsonAnswer(list_.json()); }

Answer Window::putFile(const Asked& asked) {
  if (asked.head.query.contains("as")) return arrivals_.take(asked);
  const std::string& name = asked.wanted("path");
  files_.write(name, [&asked](const std::function<void(std::string_view)>& take) { readWhole(asked, take); });
  return jsonAnswer({{"path", name}});
}

Answer Window::fileContent(const Asked& asked) {
  const std::string& name = asked.wanted("path");
  Answer answer = fileAnswer(files_.open(name), name, asked.head);
  // A drawing is a page of its own to a browser that is led here, with scripts.
  answer.headers.emplace_back("Content-Security-Policy",
                              "sandbox; default-src 'none'; frame-ancestors 'none'");
  return answer;
}

Answer Window::putScenario(const Asked& asked) {
  const std::string& name = asked.wanted("path");
  const Json json = asked.json();
  if (!name.ends_with(".yaml")) throw Refusal(415, "The name of a scenario ends in '.yaml'.");
  if (!json.contains("text") || !json["text"].is_string())
    throw Refusal(400, "The request has no 'text' of a scenario.");
  const bool has_gcode = json.contains("gcode") && !json["gcode"].is_null();
  if (has_gcode && !json["gcode"].is_string()) throw Refusal(400, "'gcode' is no text.");
  const auto save = [this](const std::string& file, const std::string& text) {
    files_.write(file, [&text](const std::function<void(std::string_view)>& take) { take(text); });
  };
  // The G-code first: a scenario that names it is never there without it.
  if (has_gcode)
    save(name.substr(0, name.size() - std::string_view(".yaml").size()) + ".gcode",
         json["gcode"].get<std::string>());
  save(name, json["text"].get<std::string>());
  return jsonAnswer({{"path", name}, {"command", "kerfbench " + shellLine({"run", name})}});
}

Answer Window::addRun(const Asked& asked) { return jsonAnswer(runs_.add(runWishFrom(asked.json()))); }

Answer Window::listRuns(const Asked&) { return jsonAnswer({{"runs", runs_.list()}}); }

Answer Window::answerRun(const Asked& asked) {
  const std::string rest = asked.head.path.substr(kRuns.size());
  const auto slash = rest.find('/');
  const std::string id = rest.substr(0, slash);
  const std::string what = slash == std::string::npos ? "" : rest.substr(slash + 1);
  if (asked.head.method == "POST") {
    if (what != "stop") throw Refusal(404, "There is nothing at this address.");
    runs_.stop(id);
    return jsonAnswer(runs_.of(id));
  }
  if (asked.head.method == "PUT") throw Refusal(405, "That is not asked in this way.");
  if (what.empty()) return jsonAnswer(runs_.of(id));
  if (what == "events")
    return streamed(runs_.events(id, numberOr0(asked.head.header("last-event-id"))), "text/event-stream");
  if (what != "trace") throw Refusal(404, "There is nothing at this address.");
  const auto from = asked.head.query.find("from");
  return streamed(runs_.trace(id, numberOr0(from == asked.head.query.end() ? nullptr : &from->second)),
                  "application/octet-stream");
}

Answer Window::traceFile(const Asked& asked) {
  const std::string& name = asked.wanted("path");
  if (!name.ends_with(".mcap")) throw Refusal(415, "The name of a trace ends in '.mcap'.");
  return fileAnswer(files_.open(name), name, asked.head);
}

Answer Window::service(const Asked& asked) {
  // Written whole by `calibrate … --by-hand`, at each call.
  const std::string name = asked.wanted("path") + "/steps.json";
  return fileAnswer(files_.open(name), name, asked.head);
}

Answer Window::station(const Asked&) {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) name.front() = '\0';
  Json runs = runs_.list();
  if (runs.size() > kMostStationRuns) runs.erase(runs.begin() + kMostStationRuns, runs.end());
  return jsonAnswer({{"name", name.data()},
                     {"version", base::version()},
                     {"folder", files_.folder().filename().string()},
                     {"can_run", ::access((setup_.bin_dir / "kerfbench").c_str(), X_OK) == 0},
                     {"runs", std::move(runs)}});
}

Answer Window::benches(const Asked&) { return jsonAnswer({{"benches", neighbours_.json()}}); }

Answer Window::streamed(std::unique_ptr<AnswerBody> body, const std::string& type) {
  auto counted = std::make_unique<CountedBody>(std::move(body), streams_);
  if (++*streams_ > kMostStreams)
    throw Refusal(503, "Too many pages follow runs at this time. Close some of them.");
  Answer answer;
  answer.type = type;
  answer.body = std::move(counted);
  return answer;
}

}  // namespace kerfbench::serve
