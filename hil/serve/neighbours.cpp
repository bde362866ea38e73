// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/neighbours.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>
#include <utility>

#include "hil/base/input_error.h"
#include "hil/serve/access.h"
#include "hil/serve/connection.h"

namespace kerfbench::serve {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// What is passed on of a bench's answer.
constexpr std::array kFields{"name", "version", "folder", "can_run", "runs"};

/// Why a bench has not answered, as a sentence.
struct NoAnswer : std::runtime_error {
  using std::runtime_error::runtime_error;
};

double leftOf(Clock::time_point until) {
  return std::max(std::chrono::duration<double>(until - Clock::now()).count(), 0.0);
}

base::UniqueFd connected(const BenchAddress& address, Clock::time_point until) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found) != 0)
    throw NoAnswer("There is no computer of this name.");
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, ::freeaddrinfo);
  for (const addrinfo* each = found; each != nullptr; each = each->ai_next) {
    base::UniqueFd fd(::socket(each->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!fd.valid()) continue;
    if (::connect(fd.get(), each->ai_addr, each->ai_addrlen) == 0) return fd;
    pollfd poller{fd.get(), POLLOUT, 0};
    if (errno != EINPROGRESS || ::poll(&poller, 1, static_cast<int>(1e3 * leftOf(until))) <= 0) continue;
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0) return fd;
  }
  throw NoAnswer("It does not answer.");
}

struct BenchReply {
  int status{};
  std::string head, body;
};

/// One request on a connection of its own.
BenchReply replyOf(const BenchAddress& address, const std::string& target, const std::string& cookie) {
  const auto until = Clock::now() + Neighbours::kPatience;
  Connection connection(connected(address, until));
  const std::string host = hostAndPort({address.host, address.port});
  const std::string request =
      fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n{}\r\n", target, host,
                  cookie.empty() ? "" : fmt::format("Cookie: {}\r\n", cookie));
  if (!connection.write(request, leftOf(until))) throw NoAnswer("It does not answer.");
  std::string all;
  std::array<char, 16 * 1024> block{};
  while (true) {
    const std::ptrdiff_t got = connection.read(block.data(), block.size(), leftOf(until));
    if (got == 0) break;
    if (got < 0 || leftOf(until) <= 0.0) throw NoAnswer("It does not answer.");
    all.append(block.data(), static_cast<std::size_t>(got));
    if (all.size() > Neighbours::kMostBytes) throw NoAnswer("It answers with too much.");
  }
  const auto end = all.find("\r\n\r\n");
  constexpr std::string_view kVersion{"HTTP/1.1 "};
  if (!all.starts_with(kVersion) || end == std::string::npos) throw NoAnswer("This is no bench.");
  return {std::atoi(all.c_str() + kVersion.size()), all.substr(0, end + 2), all.substr(end + 4)};
}

/// "name=value" of the first cookie that is set; empty: none is.
std::string cookieOf(const std::string& head) {
  constexpr std::string_view kSet{"\r\nSet-Cookie: "};
  const auto at = head.find(kSet);
  if (at == std::string::npos) return {};
  const auto from = at + kSet.size();
  return head.substr(from, head.find_first_of(";\r", from) - from);
}

}  // namespace

BenchAddress benchAddressFrom(const std::string& text) {
  static const std::regex kAddress(
      R"(http://(?:\[([0-9A-Fa-f:.]{2,45})\]|([A-Za-z0-9.-]{1,253})):([0-9]{1,5})/\?token=([A-Za-z0-9_-]{8,128}))");
  std::smatch parts;
  constexpr std::size_t kLongest = 512;
  if (text.size() > kLongest || !std::regex_match(text, parts, kAddress) || std::stoi(parts[3]) > 65535 ||
      std::stoi(parts[3]) == 0)
    throw base::InputError(fmt::format(
        "--bench {}: not an address as kerfbench serve prints it, http://192.168.0.7:8080/?token=…", text));
  return {parts[1].matched ? parts[1].str() : parts[2].str(), std::stoi(parts[3]), parts[4]};
}

/// A bench, and the session that was opened there.
class Neighbours::Neighbour {
 public:
  explicit Neighbour(BenchAddress address) : address_(std::move(address)) {}

  Json ask() {
    Json row{{"address", "http://" + hostAndPort({address_.host, address_.port}) + "/"}};
    try {
      logIn();
      const BenchReply reply = replyOf(address_, "/api/station", cookie_);
      if (reply.status == 401) throw NoAnswer("It was started anew: its new address is needed.");
      const Json said = Json::parse(reply.body, nullptr, false);
      if (reply.status != 200 || !said.is_object()) throw NoAnswer("This is no bench of this version.");
      for (const char* field : kFields)
        if (said.contains(field)) row[field] = said[field];
    } catch (const NoAnswer& why) {
      row["problem"] = why.what();
    }
    return row;
  }

 private:
  void logIn() {
    if (!cookie_.empty()) return;
    const BenchReply reply = replyOf(address_, "/?token=" + address_.token, "");
    cookie_ = cookieOf(reply.head);
    if (reply.status != 303 || cookie_.empty())
      throw NoAnswer("It does not let this bench in: its address was used before, or it was started anew.");
  }

  BenchAddress address_;
  std::string cookie_;
};

Neighbours::Neighbours(std::vector<BenchAddress> addresses) {
  if (addresses.size() > kMost) throw base::InputError(fmt::format("--bench: {} at most", kMost));
  for (BenchAddress& address : addresses) all_.push_back(std::make_unique<Neighbour>(std::move(address)));
}

Neighbours::~Neighbours() = default;

Json Neighbours::json() {
  const std::lock_guard lock(mutex_);
  if (asked_ && Clock::now() - *asked_ < kFresh) return Json::parse(answered_);
  std::vector<Json> rows(all_.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < all_.size(); ++i)
      threads.emplace_back([this, &rows, i] { rows[i] = all_[i]->ask(); });
  }
  const Json list = rows;
  answered_ = list.dump(-1, ' ', false, Json::error_handler_t::replace);
  asked_ = Clock::now();
  return list;
}

}  // namespace kerfbench::serve
