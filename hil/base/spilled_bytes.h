// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include "hil/base/spill_file.h"

namespace kerfbench::base {

/// Addresses that were had from the kernel, move-only; given back by the destructor.
class AddressRange {
 public:
  AddressRange() = default;
  /// Nothing may be read or written there until something is mapped over it. @throws std::bad_alloc.
  explicit AddressRange(std::size_t size);
  AddressRange(AddressRange&& other) noexcept;
  AddressRange& operator=(AddressRange&& other) noexcept;
  ~AddressRange();

  [[nodiscard]] std::byte* begin() const { return begin_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::byte* begin_{};
  std::size_t size_{};
};

/// The bytes of a SpilledVector, which see. Appended in whole elements, read as one piece of memory.
///
/// At first they are on the heap. Beyond `in_memory` bytes they are in a file that is mapped for reading, and
/// behind it, in the addresses that follow, stands the block that is being filled. A block that is full is
/// written to the file, the file is mapped in its place, and the block's memory moves on, so that neither
/// writing nor what is written takes memory of the process.
class SpilledBytes {
 public:
  explicit SpilledBytes(std::size_t element) : element_(element) {}
  SpilledBytes(const SpilledBytes& other);
  SpilledBytes(SpilledBytes&& other) noexcept : element_(other.element_) { swap(other); }
  SpilledBytes& operator=(SpilledBytes other) noexcept {
    swap(other);
    return *this;
  }
  ~SpilledBytes() = default;
  void swap(SpilledBytes& other) noexcept;

  [[nodiscard]] const std::byte* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Bytes of the beginning that are in a file.
  [[nodiscard]] std::size_t filed() const { return filed_; }

  /// Bytes that can be appended at once: whole elements.
  [[nodiscard]] std::size_t room() const { return room_end_ - size_; }
  /// Makes some room. @throws std::system_error as SpillFile, std::bad_alloc; then nothing has changed.
  void makeRoom();
  /// For `room()` bytes, of which appended() takes the first.
  [[nodiscard]] std::byte* end() { return data_ + size_; }
  void appended(std::size_t bytes) { size_ += bytes; }

  /// Keeps so many bytes on the heap before anything goes to a file.
  void holdInMemory(std::size_t bytes);
  /// Gives the memory of bytes in [from, to) that are in the file back to the kernel, which reads them again
  /// when they are wanted.
  void giveBack(std::size_t from, std::size_t to) const;

  /// Most bytes on the heap, unless holdInMemory() says more.
  static constexpr std::size_t kInMemory = std::size_t{8} << 20U;

 private:
  [[nodiscard]] std::size_t block() const;
  void growOnHeap(std::size_t capacity);
  /// Puts the file over a new range of addresses, the block being filled behind it.
  void map(std::size_t filed);
  void moveBlock(std::byte* to);
  void spillBlock();
  void fileOfOwn();

  std::size_t element_;
  std::size_t in_memory_{kInMemory};
  std::byte* data_{};
  std::size_t size_{};
  std::size_t room_end_{};
  std::unique_ptr<std::byte[]> heap_;
  std::shared_ptr<SpillFile> file_;
  std::size_t filed_{};
  AddressRange range_;
};

}  // namespace kerfbench::base
