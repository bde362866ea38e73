// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/topics.h"

#include "hil/trace/schemas.h"

namespace kerfbench::trace {
namespace {

struct TopicText {
  std::string_view name;
  TopicGroup group{};
  std::string_view schema;
  std::string (*json)();
};

const std::array<TopicText, kTopics>& topics() {
  static const std::array<TopicText, kTopics> kAll{{
      {"/machine", TopicGroup::kMachine, "kerfbench.Machine", machineSchema},
      {"/motion", TopicGroup::kMotion, "kerfbench.Motion", motionSchema},
      {"/pins", TopicGroup::kPins, "kerfbench.Pins", pinsSchema},
      {"/commanded", TopicGroup::kMotion, "kerfbench.Commanded", commandedSchema},
      {"/gcode", TopicGroup::kMotion, "kerfbench.Gcode", gcodeSchema},
      {"/uart", TopicGroup::kMotion, "foxglove.Log", uartSchema},
      {"/burnt", TopicGroup::kBurnt, "kerfbench.Burnt", burntSchema},
      {"/overview/100ms", TopicGroup::kOverview, "kerfbench.Overview", overviewSchema},
      {"/overview/1s", TopicGroup::kOverview, "kerfbench.Overview", overviewSchema},
      {"/overview/10s", TopicGroup::kOverview, "kerfbench.Overview", overviewSchema},
      {"/overview/100s", TopicGroup::kOverview, "kerfbench.Overview", overviewSchema},
      {"/spot", TopicGroup::kCamera, "kerfbench.Spot", spotSchema},
      {"/frames", TopicGroup::kCamera, "foxglove.CompressedImage", framesSchema},
      {"/checks", TopicGroup::kChecks, "kerfbench.Check", checkSchema},
  }};
  return kAll;
}

const TopicText& textOf(Topic topic) { return topics().at(static_cast<std::size_t>(topic)); }

}  // namespace

std::string_view topicName(Topic topic) { return textOf(topic).name; }

std::optional<Topic> topicNamed(std::string_view name) {
  for (std::size_t i = 0; i < kTopics; ++i)
    if (topics().at(i).name == name) return static_cast<Topic>(i);
  return std::nullopt;
}

TopicGroup groupOf(Topic topic) { return textOf(topic).group; }

McapSchema schemaOf(Topic topic) { return {std::string(textOf(topic).schema), textOf(topic).json()}; }

void addTopics(McapWriter& writer) {
  std::map<std::string, std::uint16_t, std::less<>> ids;
  for (const TopicText& topic : topics()) {
    auto known = ids.find(topic.schema);
    if (known == ids.end())
      known = ids.emplace(topic.schema, writer.addSchema({std::string(topic.schema), topic.json()})).first;
    writer.addChannel({std::string(topic.name), known->second});
  }
}

}  // namespace kerfbench::trace
