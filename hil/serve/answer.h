// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hil/serve/http_head.h"

namespace kerfbench::serve {

/// Content of an answer that is made while it is sent.
class AnswerBody {
 public:
  virtual ~AnswerBody() = default;
  /// The next bytes, not empty; nullopt: that was all. May wait; `is_gone` tells whether anybody still waits
  /// for them, and what waits asks it every kLookAround or more often.
  virtual std::optional<std::string> next(const std::function<bool()>& is_gone) = 0;
};

/// What a request is answered by.
struct Answer {
  int status{200};
  std::string type{"application/json"};
  std::vector<std::pair<std::string, std::string>> headers{};
  std::string text{};
  std::unique_ptr<AnswerBody> body{};         ///< Instead of the text.
  std::optional<std::uint64_t> body_bytes{};  ///< Length of the body; nullopt: nobody knows it yet.
};

/// A request that was let in.
struct Asked {
  const HttpHead& head;
  bool is_known{};  ///< Has a session.
  /// Hands on the body, piece by piece, as long as `take` returns true. False: it did not come as a whole.
  std::function<bool(const std::function<bool(std::string_view)>& take)> read_body;

  /// Value in the query. @throws Refusal 400 if it is not there.
  [[nodiscard]] const std::string& wanted(const std::string& name) const;
  /// The whole body. @throws Refusal 400 if it did not come as a whole.
  [[nodiscard]] std::string body() const;
  /// The same as JSON, an object. @throws Refusal 400 if it is none.
  [[nodiscard]] nlohmann::json json() const;
};

Answer jsonAnswer(const nlohmann::json& json);
/// {"error": sentence}
Answer errorAnswer(int status, const std::string& sentence);

/// Type of a file by the ending of its name, for a browser.
std::string typeOf(const std::string& name);

}  // namespace kerfbench::serve
