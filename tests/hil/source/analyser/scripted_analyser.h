// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/source/analyser/analyser.h"

namespace kerfbench::source {

/// A scripted analyser: these levels, and this end.
class ScriptedAnalyser final : public AnalyserSystem {
 public:
  std::vector<LevelRun> runs;  ///< Levels; cut off as the real analyser does.
  std::optional<std::string> refusal;
  AnalyserEnd::Reason if_runs_end{AnalyserEnd::Reason::kDevice};
  std::vector<std::string> problems, notes;
  AnalyserList listed;

  AnalyserRequest requested;  ///< The last one.

  AnalyserList list() override {
    if (refusal) throw AnalyserError(*refusal);
    return listed;
  }
  std::unique_ptr<AnalyserFeed> acquire(const AnalyserRequest& request) override {
    requested = request;
    if (refusal) throw AnalyserError(*refusal);
    return std::make_unique<Feed>(*this, request.listen);
  }

 private:
  class Feed final : public AnalyserFeed {
   public:
    Feed(const ScriptedAnalyser& script, const ListenFor& listen) : script_(script), listener_(listen) {}
    [[nodiscard]] std::string device() const override { return "script"; }
    bool read(std::vector<LevelRun>& into) override {
      if (state_ != Listener::State::kListening || next_ == script_.runs.size()) return false;
      std::vector<LevelRun> one{script_.runs[next_++]};
      state_ = listener_.add(one);
      into.insert(into.end(), one.begin(), one.end());
      return true;
    }
    [[nodiscard]] AnalyserEnd end() const override {
      AnalyserEnd end{script_.if_runs_end, script_.problems, script_.notes};
      if (state_ == Listener::State::kQuiet) end.reason = AnalyserEnd::Reason::kQuiet;
      if (state_ == Listener::State::kLimit) end.reason = AnalyserEnd::Reason::kLimit;
      return end;
    }

   private:
    const ScriptedAnalyser& script_;
    Listener listener_;
    Listener::State state_{Listener::State::kListening};
    std::size_t next_{};
  };
};

}  // namespace kerfbench::source
