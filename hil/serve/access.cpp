// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/access.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>
#include <utility>

#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

/// Browsers at a time; the oldest goes.
constexpr std::size_t kMostSessions = 16;

/// Takes the same time wherever the texts part.
bool areEqual(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

std::string cookieName(const ServerAddress& address) { return fmt::format("kerfbench-{}", address.port); }

/// Value of a cookie among those of the header; empty: it is not there.
std::string_view cookieIn(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    std::string_view pair = header.substr(0, header.find(';'));
    header.remove_prefix(std::min(pair.size() + 1, header.size()));
    pair.remove_prefix(std::min(pair.find_first_not_of(' '), pair.size()));
    if (pair.size() > name.size() && pair.starts_with(name) && pair[name.size()] == '=')
      return pair.substr(name.size() + 1);
  }
  return {};
}

bool changesSomething(const HttpHead& head) { return head.method == "POST" || head.method == "PUT"; }

}  // namespace

std::string randomWord() {
  constexpr std::string_view kLetters{"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"};
  std::array<unsigned char, 32> bytes{};
  for (std::size_t got = 0; got < bytes.size();) {
    const ssize_t more = ::getrandom(bytes.data() + got, bytes.size() - got, 0);
    if (more < 0 && errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "no random numbers");
    if (more > 0) got += static_cast<std::size_t>(more);
  }
  std::string word;
  for (const unsigned char byte : bytes) word += kLetters[byte % kLetters.size()];
  return word;
}

std::string hostAndPort(const ServerAddress& address) {
  const bool is_v6 = address.address.find(':') != std::string::npos;
  return is_v6 ? fmt::format("[{}]:{}", address.address, address.port)
               : fmt::format("{}:{}", address.address, address.port);
}

bool isLoopback(const std::string& address) {
  in_addr v4{};
  if (::inet_pton(AF_INET, address.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24U) == 127U;
  return address == "::1";
}

Access::Access(ServerAddress address, std::function<void(const std::string& token)> token_made)
    : address_(std::move(address)), token_made_(std::move(token_made)), results_key_(randomWord()) {
  makeToken();
}

void Access::makeToken() {
  token_ = randomWord();
  token_made_(token_);
}

bool Access::isOwnHost(std::string_view host) const {
  const std::string port = fmt::format(":{}", address_.port);
  if (isLoopback(address_.address))
    return host == hostAndPort(address_) || host == "localhost" + port || host == "127.0.0.1" + port ||
           host == "[::1]" + port;
  // Told to be reached by others: by any address as a number, but by no name, which somebody else may own.
  if (!host.ends_with(port)) return false;
  std::string number(host.substr(0, host.size() - port.size()));
  if (number.starts_with('[') && number.ends_with(']')) number = number.substr(1, number.size() - 2);
  std::array<unsigned char, sizeof(in6_addr)> parsed{};
  return ::inet_pton(AF_INET, number.c_str(), parsed.data()) == 1 ||
         ::inet_pton(AF_INET6, number.c_str(), parsed.data()) == 1;
}

void Access::checkOrigin(const HttpHead& head) const {
  const std::string* host = head.header("host");
  if (host == nullptr) throw Refusal(400, "The request does not say for which server it is (Host).");
  if (!isOwnHost(*host))
    throw Refusal(421, "This server is not called so. Use the address that kerfbench serve has printed.");
  const std::string* origin = head.header("origin");
  if (origin != nullptr && *origin != "http://" + *host)
    throw Refusal(403, "A page of another server must not ask this one.");
}

bool Access::isKnown(const HttpHead& head) const {
  const std::string* cookies = head.header("cookie");
  if (cookies == nullptr) return false;
  const std::string_view said = cookieIn(*cookies, cookieName(address_));
  const std::lock_guard lock(mutex_);
  bool is_known = false;
  for (const std::string& session : sessions_) is_known |= areEqual(session, said);
  return is_known;
}

void Access::checkMay(const HttpHead& head) const {
  if (!isKnown(head))
    throw Refusal(401,
                  "This browser has not been let in. Open the address that kerfbench serve has printed.");
  const std::string* said = head.header("x-kerfbench");
  if (changesSomething(head) && (said == nullptr || *said != "1"))
    throw Refusal(403, "A request that changes something needs the header X-Kerfbench: 1.");
}

std::optional<std::string> Access::sessionFor(std::string_view token) {
  const std::lock_guard lock(mutex_);
  if (!areEqual(token, token_)) return std::nullopt;
  if (sessions_.size() >= kMostSessions) sessions_.erase(sessions_.begin());
  sessions_.push_back(randomWord());
  makeToken();
  return fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict", cookieName(address_), sessions_.back());
}

bool Access::isResultsKey(std::string_view key) const { return areEqual(key, results_key_); }

}  // namespace kerfbench::serve
