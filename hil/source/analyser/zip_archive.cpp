// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/zip_archive.h"

#include <zip.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <utility>

#include "hil/base/input_file.h"

namespace kerfbench::source {
namespace {

/// The archive that libzip opened, or its error in words.
zip_t* opened(zip_t* archive, const std::string& path, int code) {
  if (archive != nullptr) return archive;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string words = zip_error_strerror(&error);
  zip_error_fini(&error);
  throw ZipError(path + ": no readable zip archive: " + words);
}

zip_t* archiveToRead(const std::string& path) {
  base::OpenedInput file = base::openInput(path, base::kAnySize);
  if (!file.fd.valid()) throw ZipError(path + ": no readable zip archive: " + file.refusal);
  int code = 0;
  zip_t* const archive = zip_fdopen(file.fd.get(), ZIP_CHECKCONS, &code);
  if (archive != nullptr) (void)file.fd.release();  // libzip has closed it, and reads through one of its own.
  return opened(archive, path, code);
}

zip_t* archiveToWrite(const std::string& path) {
  int code = 0;
  zip_t* const archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code);
  return opened(archive, path, code);
}

/// A part as libzip asks for it.
struct Part {
  std::uint64_t bytes{};
  std::uint64_t done{};
  ZipFill fill;

  static zip_int64_t answer(void* self, void* data, zip_uint64_t size, zip_source_cmd_t command) {
    auto& part = *static_cast<Part*>(self);
    switch (command) {
      case ZIP_SOURCE_OPEN:
      case ZIP_SOURCE_CLOSE:
      case ZIP_SOURCE_FREE:
        return 0;
      case ZIP_SOURCE_READ: {
        const std::uint64_t block = std::min(size, part.bytes - part.done);
        part.fill({static_cast<std::uint8_t*>(data), static_cast<std::size_t>(block)});
        part.done += block;
        return static_cast<zip_int64_t>(block);
      }
      case ZIP_SOURCE_STAT: {
        auto* const stat = static_cast<zip_stat_t*>(data);
        zip_stat_init(stat);
        stat->valid = ZIP_STAT_SIZE;
        stat->size = part.bytes;
        return sizeof(zip_stat_t);
      }
      case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                              ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
      default:
        return -1;
    }
  }
};

}  // namespace

struct ZipReader::Handle {
  explicit Handle(zip_t* open) : archive(open) {}
  ~Handle() { zip_discard(archive); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  zip_t* archive;
};

ZipReader::ZipReader(const std::filesystem::path& path)
    : path_(path.string()), handle_(std::make_unique<Handle>(archiveToRead(path_))) {}
ZipReader::~ZipReader() = default;

std::vector<std::string> ZipReader::names() const {
  std::vector<std::string> names;
  const zip_int64_t count = zip_get_num_entries(handle_->archive, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    if (const char* name = zip_get_name(handle_->archive, static_cast<zip_uint64_t>(i), 0))
      names.emplace_back(name);
  }
  return names;
}

std::optional<std::uint64_t> ZipReader::sizeOf(const std::string& part) const {
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat(handle_->archive, part.c_str(), 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0)
    return std::nullopt;
  return stat.size;
}

void ZipReader::read(const std::string& part,
                     const std::function<void(std::span<const std::uint8_t>)>& take) const {
  struct CloseFile {
    void operator()(zip_file_t* file) const { zip_fclose(file); }
  };
  const std::unique_ptr<zip_file_t, CloseFile> file(zip_fopen(handle_->archive, part.c_str(), 0));
  if (!file) throw ZipError(path_ + ": " + part + ": " + zip_strerror(handle_->archive));
  std::vector<std::uint8_t> block(std::size_t{1} << 18U);
  for (;;) {
    const zip_int64_t got = zip_fread(file.get(), block.data(), block.size());
    if (got < 0) throw ZipError(path_ + ": " + part + ": damaged: " + zip_file_strerror(file.get()));
    if (got == 0) return;
    take(std::span(block).first(static_cast<std::size_t>(got)));
  }
}

std::string ZipReader::text(const std::string& part, std::uint64_t most) const {
  std::string text;
  read(part, [&](std::span<const std::uint8_t> block) {
    text.append(block.begin(), block.end());
    if (text.size() > most) throw ZipError(path_ + ": " + part + ": longer than any");
  });
  return text;
}

struct ZipWriter::Handle {
  explicit Handle(zip_t* open) : archive(open) {}
  ~Handle() {
    if (archive != nullptr) zip_discard(archive);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  zip_t* archive;
  std::deque<Part> parts;  // libzip holds pointers to them.
};

ZipWriter::ZipWriter(const std::filesystem::path& path)
    : path_(path.string()), handle_(std::make_unique<Handle>(archiveToWrite(path_))) {}
ZipWriter::~ZipWriter() = default;

void ZipWriter::add(const std::string& part, std::uint64_t bytes, ZipFill fill) {
  handle_->parts.push_back({bytes, 0, std::move(fill)});
  zip_source_t* const source = zip_source_function(handle_->archive, &Part::answer, &handle_->parts.back());
  const zip_int64_t index =
      source == nullptr ? -1 : zip_file_add(handle_->archive, part.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index >= 0) {
    // A fixed date: the same pins make the same bytes.
    constexpr zip_uint16_t kFirstOfJanuary1980 = 0x21;
    zip_file_set_dostime(handle_->archive, static_cast<zip_uint64_t>(index), 0, kFirstOfJanuary1980, 0);
    return;
  }
  if (source != nullptr) zip_source_free(source);
  throw ZipError(path_ + ": " + part + ": " + zip_strerror(handle_->archive));
}

void ZipWriter::add(const std::string& part, const std::string& text) {
  add(part, text.size(), [text, at = std::size_t{0}](std::span<std::uint8_t> block) mutable {
    std::copy_n(text.begin() + static_cast<std::ptrdiff_t>(at), block.size(), block.begin());
    at += block.size();
  });
}

void ZipWriter::commit() {
  if (zip_close(handle_->archive) != 0) throw ZipError(path_ + ": " + zip_strerror(handle_->archive));
  handle_->archive = nullptr;
}

}  // namespace kerfbench::source
