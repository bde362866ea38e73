// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hil/trace/mcap_writer.h"

namespace kerfbench::trace {

/// The channels of a trace, in the order of their ids. docs/reference/trace.md says what their messages hold.
enum class Topic {
  kMachine,
  kMotion,
  kPins,
  kCommanded,
  kGcode,
  kUart,
  kBurnt,
  kOverview100ms,
  kOverview1s,
  kOverview10s,
  kOverview100s,
  kSpot,
  kFrames,
  kChecks,
};
inline constexpr std::size_t kTopics = 14;

/// Topics that share chunks, so that a reader need not unpack what it does not show.
enum class TopicGroup { kMachine, kMotion, kPins, kBurnt, kOverview, kCamera, kChecks };
inline constexpr std::size_t kTopicGroups = 7;

std::string_view topicName(Topic topic);  ///< "/motion"
std::optional<Topic> topicNamed(std::string_view name);
TopicGroup groupOf(Topic topic);
McapSchema schemaOf(Topic topic);

/// Adds the schemas and channels of all topics, so that channelOf() holds in the file.
void addTopics(McapWriter& writer);
constexpr std::uint16_t channelOf(Topic topic) {
  return static_cast<std::uint16_t>(static_cast<int>(topic) + 1);
}

/// Longest time that a message of /motion and of what goes with it holds.
inline constexpr double kBatch_s = 0.02;
/// Span of a message of /burnt.
inline constexpr double kBurntSpan_s = 1.0;
/// Rows of a message of /overview/….
inline constexpr int kOverviewRows = 100;
/// Lengths of the overview's rows, from /overview/100ms on.
inline constexpr std::array kOverviewSteps_s{0.1, 1.0, 10.0, 100.0};
/// Span of the chunks of a finished trace: what a viewer reads and unpacks to show a moment. Of burnt paths
/// it shows all that the belt still carries, some tens of seconds of little text.
constexpr double finishedChunk_s(TopicGroup group) { return group == TopicGroup::kBurnt ? 20.0 : 1.0; }
/// Name of the file in a results folder.
inline constexpr const char* kTraceFile = "run.mcap";

}  // namespace kerfbench::trace
