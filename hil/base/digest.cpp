// SPDX-License-Identifier: Apache-2.0
#include "hil/base/digest.h"

#include <openssl/evp.h>
#include <xxhash.h>

#include <array>
#include <limits>
#include <new>
#include <stdexcept>

#include "hil/base/piece_reader.h"

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

[[noreturn]] void fail() { throw std::runtime_error("SHA-256 failed"); }

}  // namespace

struct Sha256::State {
  State() : context(EVP_MD_CTX_new()) {
    if (!context) throw std::bad_alloc();
  }
  struct Free {
    void operator()(EVP_MD_CTX* owned) const { EVP_MD_CTX_free(owned); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context;
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
  if (EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr) != 1) fail();
}
Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
  if (EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()) != 1) fail();
}

std::string Sha256::digest() const {
  const State copy;
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_MD_CTX_copy_ex(copy.context.get(), state_->context.get()) != 1 ||
      EVP_DigestFinal_ex(copy.context.get(), digest.data(), &size) != 1)
    fail();
  return hexOf(std::span(digest).first(size));
}

std::string sha256(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.digest();
}

std::string checksum(std::span<const std::uint8_t> bytes) {
  XXH128_canonical_t digest{};
  XXH128_canonicalFromHash(&digest, XXH3_128bits(bytes.data(), bytes.size()));
  return hexOf(digest.digest);
}

std::string sha256File(const std::filesystem::path& path, const ProgressFn& progress) {
  PieceReader file(path, "cannot read " + path.string());
  ShareProgress told(progress, "digest of " + path.filename().string(), file.size());
  Sha256 sum;
  std::uint64_t done = 0;
  forEachPiece(file, std::numeric_limits<std::uint64_t>::max(), [&](std::string_view piece) {
    sum.add(piece);
    told.done(done += piece.size());
  });
  return sum.digest();
}

}  // namespace kerfbench::base
