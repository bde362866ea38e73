// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "hil/serve/answer.h"
#include "hil/serve/connection.h"
#include "hil/serve/http_head.h"

namespace kerfbench::serve {

/// How long an answer waits for a client that takes nothing, and a body for one that sends nothing.
inline constexpr double kPatience_s = 10.0;
/// A stranger has so long for all of an answer, a body so long and a second more for each kLeastBytes_s.
inline constexpr double kWholeAnswer_s = 30.0;
inline constexpr double kLeastBytes_s = 64.0 * 1024.0;

/// Reads the body of a request and writes its answer by cpp-httplib. Its own reader of heads sees only what
/// parseHead() has let pass, written anew, without the headers in which version 0.11.4 trips (Range,
/// Accept-Encoding, bodies in chunks).
class HttpServer {
 public:
  /// May throw a Refusal, which becomes an answer; any other exception becomes status 500.
  using Answering = std::function<Answer(const Asked&)>;

  explicit HttpServer(Answering answering);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Answers a request. False: the connection is of no further use. May be called by many threads.
  bool serve(Connection& connection, const HttpHead& head, bool is_known);
  /// Answers that are made while they are sent end.
  void stop();

 private:
  class Library;
  std::unique_ptr<Library> library_;
};

}  // namespace kerfbench::serve
