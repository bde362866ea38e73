// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/usb_enumeration.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint8_t kFromDevice = 0x80, kToDevice = 0x00, kToEndpoint = 0x02, kToClassInterface = 0x21;
constexpr std::uint8_t kClearFeature = 1, kSetAddress = 5, kGetDescriptor = 6, kSetConfiguration = 9,
                       kSetLineCoding = 0x20, kSetControlLineState = 0x22;
constexpr std::uint16_t kDevice = 0x100, kConfiguration = 0x200, kString = 0x300;
constexpr std::uint16_t kHeadBytes = 8, kDeviceBytes = 18, kConfigurationHeadBytes = 9,
                        kMostStringBytes = 255;
constexpr std::uint16_t kDtrAndRts = 3;
constexpr std::uint16_t kAddress = 1;

UsbRequest descriptor(std::uint16_t value, std::uint16_t index, std::uint16_t length, const char* what) {
  return {kFromDevice, kGetDescriptor, value, index, length, {}, std::string("GET_DESCRIPTOR of ") + what};
}

std::uint16_t wordAt(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

}  // namespace

std::vector<std::uint8_t> UsbRequest::setupBytes() const {
  std::vector<std::uint8_t> bytes{type, request};
  for (const std::uint16_t word : {value, index, length}) {
    bytes.push_back(static_cast<std::uint8_t>(word));
    bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  }
  return bytes;
}

UsbRequest clearHalt(unsigned endpoint_address) {
  return {kToEndpoint,
          kClearFeature,
          0,
          static_cast<std::uint16_t>(endpoint_address),
          0,
          {},
          "CLEAR_FEATURE of a halted endpoint"};
}

UsbRequest UsbEnumeration::request() const {
  switch (step_) {
    case Step::kDeviceHead:
      return descriptor(kDevice, 0, kHeadBytes, "the device, 8 bytes,");
    case Step::kAddress:
      return {kToDevice, kSetAddress, kAddress, 0, 0, {}, "SET_ADDRESS"};
    case Step::kDevice:
      return descriptor(kDevice, 0, kDeviceBytes, "the device");
    case Step::kConfigurationHead:
      return descriptor(kConfiguration, 0, kConfigurationHeadBytes, "the configuration, 9 bytes,");
    case Step::kConfiguration:
      return descriptor(kConfiguration, 0, configuration_bytes_, "the configuration");
    case Step::kLanguages:
      return descriptor(kString, 0, kMostStringBytes, "the languages");
    case Step::kProduct:
      return descriptor(kString | product_string_, language_, kMostStringBytes, "the product's name");
    case Step::kSetConfiguration:
      return {kToDevice, kSetConfiguration, line_.configuration, 0, 0, {}, "SET_CONFIGURATION"};
    case Step::kLineCoding: {
      std::vector<std::uint8_t> coding;
      for (unsigned i = 0; i < 4; ++i) coding.push_back(static_cast<std::uint8_t>(baud_ >> (8 * i)));
      coding.insert(coding.end(), {0, 0, 8});  // One stop bit, no parity, eight data bits.
      return {kToClassInterface, kSetLineCoding, 0, line_.control_interface, 7, coding, "SET_LINE_CODING"};
    }
    default:
      return {kToClassInterface,       kSetControlLineState, kDtrAndRts, line_.control_interface, 0, {},
              "SET_CONTROL_LINE_STATE"};
  }
}

void UsbEnumeration::finish(std::span<const std::uint8_t> answer) {
  switch (step_) {
    case Step::kDeviceHead:
      return takeDeviceHead(answer);
    case Step::kDevice:
      return takeDevice(answer);
    case Step::kConfigurationHead:
      return takeConfigurationHead(answer);
    case Step::kConfiguration:
      return takeConfiguration(answer);
    case Step::kLanguages:
      language_ = answer.size() >= 4 ? wordAt(answer, 2) : std::uint16_t{0};
      return next();
    default:
      return next();
  }
}

/// Names are for people only, and a line without a rate is one nonetheless: PSTN 1.2 lets a device refuse it.
void UsbEnumeration::stall() {
  switch (step_) {
    case Step::kLanguages:
    case Step::kProduct:
      step_ = Step::kSetConfiguration;
      return;
    case Step::kLineCoding:
    case Step::kControlLines:
      return next();
    default:
      refuse("answers " + request().name + " with a STALL");
  }
}

void UsbEnumeration::takeDeviceHead(std::span<const std::uint8_t> answer) {
  const unsigned bytes = answer.size() == kHeadBytes ? answer[7] : 0;
  if (bytes != 8 && bytes != 16 && bytes != 32 && bytes != 64)
    return refuse("answers " + request().name + " with " + std::to_string(answer.size()) +
                  " bytes and packets of " + std::to_string(bytes));
  control_bytes_ = bytes;
  next();
}

void UsbEnumeration::takeDevice(std::span<const std::uint8_t> answer) {
  if (answer.size() != kDeviceBytes)
    return refuse("answers " + request().name + " with " + std::to_string(answer.size()) + " bytes");
  product_string_ = answer[15];
  next();
}

void UsbEnumeration::takeConfigurationHead(std::span<const std::uint8_t> answer) {
  configuration_bytes_ = answer.size() == kConfigurationHeadBytes ? wordAt(answer, 2) : std::uint16_t{0};
  if (configuration_bytes_ < kConfigurationHeadBytes)
    return refuse("answers " + request().name + " with " + std::to_string(answer.size()) +
                  " bytes, of a configuration of " + std::to_string(configuration_bytes_));
  next();
}

void UsbEnumeration::takeConfiguration(std::span<const std::uint8_t> answer) {
  if (answer.size() != configuration_bytes_)
    return refuse("answers " + request().name + " with " + std::to_string(answer.size()) + " bytes of " +
                  std::to_string(configuration_bytes_));
  std::string words;
  const auto line = findCdcLine(answer, words);
  is_other_ = !line;
  if (!line) return refuse(words);
  line_ = *line;
  step_ = product_string_ != 0 ? Step::kLanguages : Step::kSetConfiguration;
}

}  // namespace kerfbench::cortex_m_child
