// SPDX-License-Identifier: Apache-2.0
#include "hil/source/pin_stream.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>

#include "hil/base/unique_fd.h"
#include "hil/source/emulator/wire.h"
#include "hil/source/open.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {
namespace {

/// A child behind a connection that says what it is given, whatever it is asked.
class TalkingChild {
 public:
  TalkingChild() : listening_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    auto* const general = reinterpret_cast<sockaddr*>(&address_);
    if (::bind(listening_.get(), general, size) != 0 || ::listen(listening_.get(), 4) != 0 ||
        ::getsockname(listening_.get(), general, &size) != 0)
      throw std::runtime_error("no port to listen at");
  }
  [[nodiscard]] std::string name() const {
    return "tcp:127.0.0.1:" + std::to_string(ntohs(address_.sin_port));
  }

  /// Answers one connection, if one comes before it is over. The end of what it says is the end of the child.
  void answer(Bytes said, const std::atomic<bool>& is_over) const {
    constexpr int kLook_ms = 20;
    for (pollfd asked{listening_.get(), POLLIN, 0}; ::poll(&asked, 1, kLook_ms) <= 0;) {
      if (is_over) return;
    }
    const base::UniqueFd bench(::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    for (std::size_t done = 0; done < said.size();) {
      const ssize_t sent = ::send(bench.get(), said.data() + done, said.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) break;
      done += static_cast<std::size_t>(sent);
    }
    (void)::shutdown(bench.get(), SHUT_WR);
    // Until the bench goes, so that it is never reset.
    for (char piece[4096]; ::recv(bench.get(), piece, sizeof piece, 0) > 0;) {
    }
  }

 private:
  base::UniqueFd listening_;
  sockaddr_in address_{};
};

}  // namespace

/// Bench's side: the bytes are a child's replies. True where it said HELLO and a batch.
bool pinStreamReplies(Bytes bytes) {
  static const TalkingChild kChild;
  constexpr Tick kQuantum = 8000;
  constexpr int kMostQuanta = 32;
  bool has_talked = false;
  std::atomic<bool> is_over{false};
  std::thread child([&] { kChild.answer(bytes, is_over); });
  (void)takes<std::runtime_error>([&] {
    source::ChildSourceOptions options;
    options.child = kChild.name();
    options.image = asFile("image", std::string_view());  // A digest of it is taken.
    const auto pins = source::openChild(options);
    source::Batch batch;
    Tick until = 0;
    for (int i = 0; i < kMostQuanta; ++i) {
      until += kQuantum;
      if (pins->advance(until, batch) != source::Stop::kReached) break;
      has_talked = true;
    }
  });
  is_over = true;
  child.join();
  return has_talked;
}

/// Child's side: the bytes are the bench's requests. True where all of them were whole messages.
bool pinStreamRequests(Bytes bytes) {
  const base::UniqueFd pipe(::memfd_create("requests", MFD_CLOEXEC));
  if (::write(pipe.get(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()) ||
      ::lseek(pipe.get(), 0, SEEK_SET) != 0)
    throw std::runtime_error("no file for the requests");
  try {
    emulator::Requests requests(pipe.get());
    for (;;) {
      const emulator::Message message = requests.next();
      emulator::FieldReader in(message.payload);
      if (message.type != KB_PS_OPEN) continue;
      (void)in.integer<std::uint32_t>();
      (void)in.integer<std::uint64_t>();
      (void)in.integer<std::uint32_t>();
      (void)in.integer<std::uint64_t>();
      (void)in.text();
      (void)in.text();
      in.finish();
    }
  } catch (const emulator::EndOfRequests&) {
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

}  // namespace kerfbench::fuzz
