// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/http_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>
#include <vector>

#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

constexpr std::array kMethods{"GET", "HEAD", "POST", "PUT"};
constexpr std::string_view kLineEnd{"\r\n"};

bool isControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

bool isLetterOrDigit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// A token of RFC 9110.
bool isToken(std::string_view text) {
  constexpr std::string_view kOthers{"!#$%&'*+-.^_`|~"};
  return !text.empty() && std::ranges::all_of(text, [&](char c) {
    return isLetterOrDigit(c) || kOthers.find(c) != std::string_view::npos;
  });
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string_view trimmedSpaces(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string decodedOrRefused(std::string_view text, bool is_form) {
  std::optional<std::string> decoded = percentDecoded(text, is_form);
  if (!decoded || std::ranges::any_of(*decoded, isControl))
    throw Refusal(400, "The address of the request is not encoded as it should be.");
  return *std::move(decoded);
}

void readQuery(std::string_view query, HttpHead& head) {
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(pair.size() + 1, query.size()));
    if (pair.empty()) continue;
    const auto equals = pair.find('=');
    const std::string name = decodedOrRefused(pair.substr(0, equals), true);
    const std::string value =
        equals == std::string_view::npos ? "" : decodedOrRefused(pair.substr(equals + 1), true);
    if (!head.query.emplace(name, value).second)
      throw Refusal(400, fmt::format("The request has '{}' twice.", name));
  }
}

void readTarget(std::string_view target, HttpHead& head) {
  const auto is_visible = [](char c) { return c > 0x20 && c < 0x7f; };
  if (!target.starts_with('/') || !std::ranges::all_of(target, is_visible) ||
      target.find('#') != std::string_view::npos)
    throw Refusal(400, "The address of the request is not one of this server.");
  const auto mark = target.find('?');
  const std::string_view path = target.substr(0, mark);
  const std::string_view query = mark == std::string_view::npos ? "" : target.substr(mark + 1);
  if (path.size() > kMostPathBytes || query.size() > kMostQueryBytes)
    throw Refusal(414, "The address of the request is too long.");
  head.target = target;
  head.path = decodedOrRefused(path, false);
  readQuery(query, head);
}

void readRequestLine(std::string_view line, HttpHead& head) {
  const auto first = line.find(' ');
  const auto last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) throw Refusal(400, "This is no request of HTTP.");
  head.method = line.substr(0, first);
  const std::string_view version = line.substr(last + 1);
  if (version != "HTTP/1.1") throw Refusal(505, "This server speaks HTTP/1.1.");
  if (std::ranges::find(kMethods, head.method) == kMethods.end())
    throw Refusal(405, "This server knows GET, HEAD, POST and PUT.");
  readTarget(line.substr(first + 1, last - first - 1), head);
}

void readHeader(std::string_view line, HttpHead& head) {
  const auto colon = line.find(':');
  if (colon == std::string_view::npos || !isToken(line.substr(0, colon)))
    throw Refusal(400, "A header of the request has no name.");
  const std::string_view value = trimmedSpaces(line.substr(colon + 1));
  if (std::ranges::any_of(value, [](char c) { return isControl(c) && c != '\t'; }))
    throw Refusal(400, "A header of the request has a control character.");
  if (head.headers.size() >= kMostHeaders) throw Refusal(431, "The request has too many headers.");
  std::string name = lowerCase(line.substr(0, colon));
  if (!head.headers.emplace(std::move(name), value).second)
    throw Refusal(400, fmt::format("The request has the header {} twice.", line.substr(0, colon)));
}

void readBodyLength(HttpHead& head) {
  if (head.header("transfer-encoding") != nullptr)
    throw Refusal(501, "This server takes no body in chunks: send it with its length.");
  const std::string* length = head.header("content-length");
  if (length == nullptr) {
    if (head.method == "POST" || head.method == "PUT")
      throw Refusal(411, "The request does not say how long its body is.");
    return;
  }
  const bool is_number = !length->empty() && length->size() <= 18 &&
                         std::ranges::all_of(*length, [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) throw Refusal(400, "The length of the request's body is no number.");
  std::from_chars(length->data(), length->data() + length->size(), head.body_bytes);
  if (head.body_bytes > 0 && (head.method == "GET" || head.method == "HEAD"))
    throw Refusal(400, "A request that only reads has no body.");
}

}  // namespace

const std::string* HttpHead::header(const std::string& lower_case_name) const {
  const auto found = headers.find(lower_case_name);
  return found == headers.end() ? nullptr : &found->second;
}

std::optional<std::size_t> headLength(std::string_view bytes) {
  const auto end = bytes.find("\r\n\r\n");
  if (end == std::string_view::npos) return std::nullopt;
  return end + 4;
}

HttpHead parseHead(std::string_view bytes) {
  if (bytes.size() > kMostHeadBytes) throw Refusal(431, "The head of the request is too long.");
  HttpHead head;
  bool is_first = true;
  while (true) {
    const auto end = bytes.find(kLineEnd);
    if (end == std::string_view::npos) throw Refusal(400, "The head of the request has no end.");
    const std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(end + kLineEnd.size());
    if (line.find_first_of(std::string_view("\r\n\0", 3)) != std::string_view::npos)
      throw Refusal(400, "A line of the request has no proper end.");
    if (is_first)
      readRequestLine(line, head);
    else if (line.empty())
      break;
    else
      readHeader(line, head);
    is_first = false;
  }
  readBodyLength(head);
  if (const std::string* connection = head.header("connection"))
    head.keep_alive = lowerCase(*connection) != "close";
  return head;
}

std::optional<std::string> percentDecoded(std::string_view text, bool is_form) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += is_form && text[i] == '+' ? ' ' : text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = hexDigit(text[i + 1]), low = hexDigit(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    decoded += static_cast<char>(16 * high + low);
    i += 2;
  }
  return decoded;
}

std::string percentEncoded(std::string_view text) {
  constexpr std::string_view kPlain{"-._~/"};
  std::string encoded;
  for (const char c : text) {
    if (isLetterOrDigit(c) || kPlain.find(c) != std::string_view::npos)
      encoded += c;
    else
      encoded += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return encoded;
}

}  // namespace kerfbench::serve
