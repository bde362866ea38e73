// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/serve/http_head.h"

namespace kerfbench::serve {

/// How the server is reached.
struct ServerAddress {
  std::string address;  ///< As a number, IPv4 or IPv6: "127.0.0.1".
  int port{};           ///< 1 … 65535.
};

/// Who may do what. A token opens a session once, and the session's cookie is asked for by everything that
/// tells or does anything. A page of somebody else, which the user's browser shows as well, cannot use it:
/// Host must be this server's (a name that somebody lets point here, DNS rebinding, is none), Origin too
/// where a browser says it, and whatever changes something needs a header that a page from elsewhere cannot
/// send without being asked for (CORS).
///
/// The cookie goes to every port of this host (RFC 6265, 8.5): another program of this computer that the user
/// visits on 127.0.0.1 gets it. Whoever can run programs here is not kept out.
///
/// May be used by several threads.
class Access {
 public:
  /// `token_made` is told each token that is made, the first one at once. One that was used has a successor,
  /// so that another browser can be let in.
  Access(ServerAddress address, std::function<void(const std::string& token)> token_made);

  /// Refuses requests for another server, and those of pages of other servers.
  /// @throws Refusal 400, 403 or 421.
  void checkOrigin(const HttpHead& head) const;
  /// Whether the request has the cookie of a session.
  [[nodiscard]] bool isKnown(const HttpHead& head) const;
  /// @throws Refusal 401 without a session; 403 if it changes something and does not say X-Kerfbench.
  void checkMay(const HttpHead& head) const;

  /// Value of Set-Cookie for a token, which is worth nothing afterwards; nullopt: it is not the one.
  std::optional<std::string> sessionFor(std::string_view token);
  /// A word for addresses of results, which their pages give to their pictures: it lets read results and does
  /// nothing else. Pages of results run apart from this server's own, without its cookie.
  [[nodiscard]] const std::string& resultsKey() const { return results_key_; }
  [[nodiscard]] bool isResultsKey(std::string_view key) const;

 private:
  [[nodiscard]] bool isOwnHost(std::string_view host) const;
  void makeToken();

  ServerAddress address_;
  std::function<void(const std::string&)> token_made_;
  std::string results_key_;
  mutable std::mutex mutex_;
  std::string token_;
  std::vector<std::string> sessions_;
};

/// 192 random bits of the kernel, as letters and digits. @throws std::system_error.
std::string randomWord();

/// "127.0.0.1:8080", "[::1]:8080".
std::string hostAndPort(const ServerAddress& address);
/// Whether only this computer reaches it.
bool isLoopback(const std::string& address);

}  // namespace kerfbench::serve
