// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace kerfbench::serve {

/// What a head may be at most. A browser's own are below 2 kB; names of files may be long.
inline constexpr std::size_t kMostHeadBytes = 16 * 1024;
inline constexpr std::size_t kMostPathBytes = 1024;
inline constexpr std::size_t kMostQueryBytes = 8 * 1024;
inline constexpr std::size_t kMostHeaders = 64;

/// The head of a request (RFC 9112), as strictly as browsers write it.
struct HttpHead {
  std::string method;                          ///< GET, HEAD, POST or PUT.
  std::string target;                          ///< As it was sent: path and query, percent-encoded.
  std::string path;                            ///< Decoded; begins with '/', has no control character.
  std::map<std::string, std::string> query;    ///< Decoded, each name once.
  std::map<std::string, std::string> headers;  ///< Names in lower case, each once; values as they were sent.
  std::uint64_t body_bytes{};                  ///< Content-Length.
  bool keep_alive{true};

  /// nullptr: the header is not there.
  [[nodiscard]] const std::string* header(const std::string& lower_case_name) const;
};

/// Length of a head that ends in these bytes, its empty line included; nullopt: it goes on.
std::optional<std::size_t> headLength(std::string_view bytes);

/// Reads a head, its empty line included. Everything doubtful is refused: two readers of one request (this
/// one, and the library behind it) must never find two different requests in it. So no Transfer-Encoding
/// (CVE-2025-46728, CVE-2025-53629 and CVE-2026-45352 of cpp-httplib), no folded, repeated or nameless
/// header, no line that ends without a carriage return, no control character, no broken percent-encoding.
/// @throws Refusal 400, 405, 411, 414, 431, 501 or 505.
HttpHead parseHead(std::string_view bytes);

/// "a%20b" and, of a form, "a+b"; nullopt for broken encoding.
std::optional<std::string> percentDecoded(std::string_view text, bool is_form);
/// Everything but letters, digits and "-._~/" is encoded.
std::string percentEncoded(std::string_view text);

}  // namespace kerfbench::serve
