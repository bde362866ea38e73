// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/arrivals.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>

#include "hil/base/piece_reader.h"
#include "hil/base/temporary.h"
#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCompared = 64 * 1024;

bool haveTheSameBytes(const fs::path& a, const fs::path& b) {
  base::PieceReader one(a, a.string()), other(b, b.string());
  if (one.size() != other.size()) return false;
  std::string of_one(kCompared, '\0'), of_other(kCompared, '\0');
  while (const std::size_t bytes = one.read(of_one)) {
    if (other.read(of_other) != bytes ||
        std::string_view(of_one).substr(0, bytes) != std::string_view(of_other).substr(0, bytes))
      return false;
  }
  return true;
}

void copyInto(const fs::path& file, const std::function<void(std::string_view)>& take) {
  base::PieceReader reader(file, file.string());
  base::forEachPiece(reader, reader.size(), take);
}

}  // namespace

void readWhole(const Asked& asked, const std::function<void(std::string_view)>& take) {
  std::uint64_t bytes = 0;
  const bool is_whole = asked.read_body([&](std::string_view piece) {
    take(piece);
    bytes += piece.size();
    return true;
  });
  if (!is_whole || bytes != asked.head.body_bytes) throw Refusal(400, "The file did not come as a whole.");
}

Answer Arrivals::take(const Asked& asked) const {
  const std::string& name = asked.wanted("path");
  const std::string& as = asked.wanted("as");
  if (as != "new" && as != "replace") throw Refusal(400, "'as' is neither 'new' nor 'replace'.");
  files_.refuseUnwritable(name);
  const fs::path place = files_.placeOf(name);
  const base::TemporaryFolder waiting(fs::temp_directory_path(), "kerfbench-arrival");
  const fs::path file = waiting.path() / place.filename();
  {
    std::ofstream stream(file, std::ios::binary);
    readWhole(asked, [&stream](std::string_view piece) {
      stream.write(piece.data(), static_cast<std::streamsize>(piece.size()));
    });
    stream.close();
    if (!stream) throw std::system_error(errno, std::generic_category(), file.string());
  }
  desk_.refuseUncuttable(file, name);
  std::error_code error;
  const bool is_there = fs::exists(place, error);
  const bool is_same = is_there && haveTheSameBytes(file, place);
  if (is_there && !is_same && as != "replace")
    throw Refusal(409, fmt::format("'{}' is in the folder already, and is another file.", name));
  if (!is_same)
    files_.write(name, [&](const std::function<void(std::string_view)>& write) { copyInto(file, write); });
  return jsonAnswer({{"path", name}, {"was_there", is_same}});
}

}  // namespace kerfbench::serve
