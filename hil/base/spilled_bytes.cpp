// SPDX-License-Identifier: Apache-2.0
#include "hil/base/spilled_bytes.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <numeric>
#include <utility>

namespace kerfbench::base {
namespace {

constexpr std::size_t kLeastBlock = std::size_t{1} << 20U;
constexpr std::size_t kLeastRange = std::size_t{64} << 20U;
constexpr std::size_t kFirstElements = 64;
constexpr std::size_t kCopied = std::size_t{1} << 20U;

std::size_t pageSize() {
  static const auto size = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return size;
}

std::size_t roundedUp(std::size_t value, std::size_t to) { return (value + to - 1) / to * to; }

bool mapFile(std::byte* at, std::size_t size, int fd, std::size_t offset) {
  if (::mmap(at, size, PROT_READ, MAP_SHARED | MAP_FIXED, fd, static_cast<off_t>(offset)) == MAP_FAILED)
    return false;
  // Live pins lock all memory of the program, also what is mapped later, and locked pages stay.
  (void)::munlock(at, size);
  return true;
}

bool mapMemory(std::byte* at, std::size_t size) {
  return ::mmap(at, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) !=
         MAP_FAILED;
}

}  // namespace

AddressRange::AddressRange(std::size_t size) : size_(size) {
  void* const begin = ::mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (begin == MAP_FAILED) throw std::bad_alloc();
  begin_ = static_cast<std::byte*>(begin);
}
AddressRange::AddressRange(AddressRange&& other) noexcept
    : begin_(std::exchange(other.begin_, nullptr)), size_(std::exchange(other.size_, 0)) {}
AddressRange& AddressRange::operator=(AddressRange&& other) noexcept {
  std::swap(begin_, other.begin_);
  std::swap(size_, other.size_);
  return *this;
}
AddressRange::~AddressRange() {
  if (begin_ != nullptr) ::munmap(begin_, size_);
}

SpilledBytes::SpilledBytes(const SpilledBytes& other)
    : element_(other.element_), in_memory_(other.in_memory_), size_(other.size_), file_(other.file_) {
  if (file_) {
    map(other.filed_);
  } else if (size_ > 0) {
    heap_ = std::make_unique_for_overwrite<std::byte[]>(size_);
    data_ = heap_.get();
    room_end_ = size_;
  }
  if (size_ > filed_) std::memcpy(data_ + filed_, other.data_ + filed_, size_ - filed_);
}

void SpilledBytes::swap(SpilledBytes& other) noexcept {
  std::swap(element_, other.element_);
  std::swap(in_memory_, other.in_memory_);
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(room_end_, other.room_end_);
  std::swap(heap_, other.heap_);
  std::swap(file_, other.file_);
  std::swap(filed_, other.filed_);
  std::swap(range_, other.range_);
}

/// Whole elements and whole pages.
std::size_t SpilledBytes::block() const { return roundedUp(kLeastBlock, std::lcm(element_, pageSize())); }

void SpilledBytes::makeRoom() {
  if (room() > 0) return;
  if (file_) return spillBlock();
  const std::size_t most = roundedUp(in_memory_, block());
  if (size_ < most) return growOnHeap(std::min(most, std::max(2 * size_, kFirstElements * element_)));
  auto file = std::make_shared<SpillFile>(spillFolder());
  (void)file->claim(0, size_);
  file->write(0, {data_, size_});
  file_ = std::move(file);
  try {
    map(size_);
  } catch (...) {
    file_.reset();
    throw;
  }
  heap_.reset();
}

void SpilledBytes::growOnHeap(std::size_t capacity) {
  auto larger = std::make_unique_for_overwrite<std::byte[]>(capacity);
  if (size_ > 0) std::memcpy(larger.get(), data_, size_);
  heap_ = std::move(larger);
  data_ = heap_.get();
  room_end_ = capacity;
}

void SpilledBytes::holdInMemory(std::size_t bytes) {
  in_memory_ = std::max(in_memory_, bytes);
  const std::size_t capacity = roundedUp(bytes, block());
  if (!file_ && capacity > room_end_) growOnHeap(capacity);
}

void SpilledBytes::map(std::size_t filed) {
  AddressRange range(std::max(kLeastRange, 2 * (filed + block())));
  if (!mapFile(range.begin(), filed, file_->fd(), 0) || !mapMemory(range.begin() + filed, block()))
    throw std::bad_alloc();
  range_ = std::move(range);
  data_ = range_.begin();
  filed_ = filed;
  room_end_ = filed + block();
}

void SpilledBytes::moveBlock(std::byte* to) {
  // The pages move, so that the kernel need not give zeroed ones again. The old place stays taken: an address
  // that is free for a moment may go to another thread.
  if (::mremap(data_ + filed_, block(), block(), MREMAP_MAYMOVE | MREMAP_FIXED | MREMAP_DONTUNMAP, to) !=
      MAP_FAILED)
    return;
  if (!mapMemory(to, block())) throw std::bad_alloc();
}

void SpilledBytes::spillBlock() {
  if (!file_->claim(filed_, block())) fileOfOwn();
  file_->write(filed_, {data_ + filed_, block()});
  const std::size_t filed = filed_ + block();
  if (filed + block() > range_.size()) return map(filed);
  moveBlock(data_ + filed);
  if (!mapFile(data_ + filed_, block(), file_->fd(), filed_)) {
    // The block has moved away from here, and what it held is in the file as well.
    if (!mapMemory(data_ + filed_, block())) std::terminate();
    std::memcpy(data_ + filed_, data_ + filed, block());
    throw std::bad_alloc();
  }
  filed_ = filed;
  room_end_ = filed + block();
}

/// A copy has gone on behind what both have: the file from there on is the other's.
void SpilledBytes::fileOfOwn() {
  auto file = std::make_shared<SpillFile>(file_->folder());
  (void)file->claim(0, filed_ + block());
  for (std::size_t at = 0; at < filed_; at += kCopied) {
    const std::size_t size = std::min(kCopied, filed_ - at);
    file->write(at, {data_ + at, size});
    giveBack(at, at + size);
  }
  file_ = std::move(file);
}

void SpilledBytes::giveBack(std::size_t from, std::size_t to) const {
  from = roundedUp(from, pageSize());
  to = std::min(to, filed_) / pageSize() * pageSize();
  if (from < to) (void)::madvise(data_ + from, to - from, MADV_DONTNEED);
}

}  // namespace kerfbench::base
