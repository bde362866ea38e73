// SPDX-License-Identifier: Apache-2.0
#include "hil/base/digest.h"

#include <openssl/evp.h>
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "hil/base/file_content.h"

namespace kerfbench::base {

namespace {

std::string hexOf(std::span<const unsigned char> bytes) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kHex[byte >> 4U];
    text += kHex[byte & 15U];
  }
  return text;
}

}  // namespace

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 failed");
  }
  return hexOf(std::span(digest).first(size));
}

std::string checksum(std::span<const std::uint8_t> bytes) {
  XXH128_canonical_t digest{};
  XXH128_canonicalFromHash(&digest, XXH3_128bits(bytes.data(), bytes.size()));
  return hexOf(digest.digest);
}

std::string sha256File(const std::filesystem::path& path) {
  const std::optional<std::string> content = fileContent(path);
  if (!content) throw std::system_error(errno, std::generic_category(), "cannot read " + path.string());
  return sha256(*content);
}

}  // namespace kerfbench::base
