// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/http_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <chrono>
#include <ctime>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <utility>

#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::time_t kKeptByClient_s = 50;  // DoorLimits::idle is a minute.
constexpr std::size_t kKeptRequests = 10'000;

/// The connection as the library sees it: the head written anew, then as many bytes as the body has.
class GuardedStream final : public httplib::Stream {
 public:
  GuardedStream(Connection& connection, const HttpHead& head, bool is_known)
      : connection_(connection), is_known_(is_known), head_(headText(head)), body_left_(head.body_bytes) {}

  [[nodiscard]] bool is_readable() const override { return !head_.empty() || body_left_ > 0; }
  [[nodiscard]] bool is_writable() const override { return !is_broken_ && !connection_.isGone(); }

  ssize_t read(char* to, std::size_t size) override {
    if (!head_.empty()) {
      const std::size_t taken = head_.copy(to, size);
      head_.erase(0, taken);
      return static_cast<ssize_t>(taken);
    }
    const std::size_t wanted = std::min<std::uint64_t>(size, body_left_);
    if (wanted == 0) return 0;
    const double allowed_s = kWholeAnswer_s + static_cast<double>(body_read_) / kLeastBytes_s;
    if (is_broken_ || spent_s() > allowed_s) return fail();
    const std::ptrdiff_t got = connection_.read(to, wanted, kPatience_s);
    if (got <= 0) return fail();
    body_left_ -= static_cast<std::uint64_t>(got);
    body_read_ += static_cast<std::uint64_t>(got);
    return got;
  }

  ssize_t write(const char* bytes, std::size_t size) override {
    if (is_broken_ || (!is_known_ && spent_s() > kWholeAnswer_s)) return fail();
    if (!connection_.write({bytes, size}, kPatience_s)) return fail();
    return static_cast<ssize_t>(size);
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override { nowhere(ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override { nowhere(ip, port); }
  [[nodiscard]] socket_t socket() const override { return connection_.fd(); }

  /// Whether what comes next on the connection is a request.
  [[nodiscard]] bool isClean() const { return !is_broken_ && head_.empty() && body_left_ == 0; }

 private:
  static std::string headText(const HttpHead& head) {
    std::string text = fmt::format("{} {} HTTP/1.1\r\n", head.method, head.target);
    if (head.body_bytes > 0 || head.header("content-length") != nullptr)
      text += fmt::format("Content-Length: {}\r\n", head.body_bytes);
    const std::string* expect = head.header("expect");
    if (expect != nullptr && *expect == "100-continue") text += "Expect: 100-continue\r\n";
    return text + "\r\n";
  }
  static void nowhere(std::string& ip, int& port) {
    ip.clear();
    port = 0;
  }
  [[nodiscard]] double spent_s() const {
    return std::chrono::duration<double>(Clock::now() - begun_).count();
  }
  ssize_t fail() {
    is_broken_ = true;
    return -1;
  }

  Connection& connection_;
  bool is_known_;
  std::string head_;
  std::uint64_t body_left_;
  std::uint64_t body_read_{};
  bool is_broken_{};
  Clock::time_point begun_{Clock::now()};
};

/// What the library's handlers answer; it calls them in the thread of serve().
struct Current {
  const HttpHead* head{};
  const GuardedStream* stream{};
  bool is_known{};
};
thread_local Current current;

Answer answerOf(const HttpServer::Answering& answering, const Asked& asked) {
  try {
    return answering(asked);
  } catch (const Refusal& refusal) {
    return errorAnswer(refusal.status(), refusal.what());
  } catch (const std::bad_alloc&) {
    return errorAnswer(507, "There is not enough memory for that.");
  } catch (const std::exception& broken) {
    return errorAnswer(500, broken.what());
  }
}

/// Sends pieces of a body whose length is known, from where the library is.
void provideKnown(httplib::Response& response, std::shared_ptr<AnswerBody> body, std::uint64_t bytes,
                  const std::string& type) {
  response.set_content_provider(
      bytes, type,
      [body = std::move(body), stream = current.stream](std::size_t, std::size_t, httplib::DataSink& sink) {
        const auto piece = body->next([stream] { return !stream->is_writable(); });
        return piece && sink.write(piece->data(), piece->size());
      });
}

void provideUnknown(httplib::Response& response, std::shared_ptr<AnswerBody> body, const std::string& type) {
  response.set_chunked_content_provider(
      type, [body = std::move(body), stream = current.stream](std::size_t, httplib::DataSink& sink) {
        const auto piece = body->next([stream] { return !stream->is_writable(); });
        if (!piece) {
          sink.done();
          return true;
        }
        return sink.write(piece->data(), piece->size());
      });
}

void write(Answer answer, httplib::Response& response) {
  response.status = answer.status;
  for (const auto& [name, value] : answer.headers) response.set_header(name, value);
  if (!answer.body)
    response.set_content(answer.text, answer.type);
  else if (answer.body_bytes && *answer.body_bytes == 0)
    response.set_content("", answer.type);
  else if (answer.body_bytes)
    provideKnown(response, std::move(answer.body), *answer.body_bytes, answer.type);
  else
    provideUnknown(response, std::move(answer.body), answer.type);
}

}  // namespace

class HttpServer::Library final : public httplib::Server {
 public:
  explicit Library(Answering answering) : answering_(std::move(answering)) {
    // What the library says of connections, which are the door's: a browser is to close one before the door
    // does.
    set_keep_alive_timeout(kKeptByClient_s);
    set_keep_alive_max_count(kKeptRequests);
    svr_sock_ = 0;  // The library sends no body while it believes that it does not listen.
    Get(".*", [this](const httplib::Request&, httplib::Response& response) {
      const auto no_body = [](const auto&) { return true; };
      write(answerOf(answering_, {*current.head, current.is_known, no_body}), response);
    });
    const auto with_body = [this](const httplib::Request&, httplib::Response& response,
                                  const httplib::ContentReader& read) {
      const auto read_body = [&read](const std::function<bool(std::string_view)>& take) {
        return read([&take](const char* bytes, std::size_t size) { return take({bytes, size}); });
      };
      write(answerOf(answering_, {*current.head, current.is_known, read_body}), response);
    };
    Post(".*", with_body);
    Put(".*", with_body);
  }

  bool serve(Connection& connection, const HttpHead& head, bool is_known) {
    GuardedStream stream(connection, head, is_known);
    current = {&head, &stream, is_known};
    bool is_closed = false;
    const bool went_well = process_request(stream, !head.keep_alive, is_closed, nullptr);
    current = {};
    return went_well && !is_closed && head.keep_alive && stream.isClean();
  }

  void stopStreams() { svr_sock_ = INVALID_SOCKET; }

 private:
  Answering answering_;
};

HttpServer::HttpServer(Answering answering) : library_(std::make_unique<Library>(std::move(answering))) {}

HttpServer::~HttpServer() = default;

bool HttpServer::serve(Connection& connection, const HttpHead& head, bool is_known) {
  return library_->serve(connection, head, is_known);
}

void HttpServer::stop() { library_->stopStreams(); }

}  // namespace kerfbench::serve
