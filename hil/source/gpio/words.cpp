// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/words.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

namespace kerfbench::source {
namespace {

constexpr char kOldKernel[] =
    "the kernel lacks the second GPIO interface (Linux 5.10 with CONFIG_GPIO_CDEV); the first one loses "
    "edges "
    "without a word and is not used";

std::string system(int error) { return std::generic_category().message(error); }

}  // namespace

std::string openWords(const std::string& chip, int error) {
  switch (error) {
    case ENOENT:
      return chip + ": no such chip; `kerfbench doctor` lists those that are there";
    case EACCES:
    case EPERM:
      return chip +
             ": not allowed; as a rule in /etc/udev/rules.d/60-gpio.rules put SUBSYSTEM==\"gpio\", "
             "KERNEL==\"gpiochip*\", GROUP=\"gpio\", MODE=\"0660\", and yourself into the group gpio";
    case ENODEV:
    case ENXIO:
      return chip + ": the chip has gone";
    default:
      return chip + ": cannot be opened: " + system(error);
  }
}

std::string chipWords(const std::string& chip, int error) {
  switch (error) {
    case ENOTTY:
    case EINVAL:
      return chip + ": is no gpiochip";
    case ENODEV:
      return chip + ": the chip has gone";
    default:
      return chip + ": does not say what it is: " + system(error);
  }
}

std::string lineInfoWords(const std::string& chip, int error) {
  switch (error) {
    case ENOTTY:
    case EINVAL:
      return chip + ": " + kOldKernel;
    case ENODEV:
      return chip + ": the chip has gone";
    default:
      return chip + ": does not say what its lines are: " + system(error);
  }
}

std::string takenWords(const std::string& chip, std::uint32_t offset, const std::string& name,
                       const std::string& consumer) {
  return fmt::format("{}: line {} for {} is taken by {}", chip, offset, name,
                     consumer.empty() ? "somebody who gives no name" : "'" + consumer + "'");
}

std::string requestWords(const std::string& chip, int error) {
  switch (error) {
    case EBUSY:
      return chip + ": a line was taken by someone else just now";
    case EACCES:
    case EPERM:
      return chip + ": lines of this chip may not be used as inputs";
    case ENOTTY:
      return chip + ": " + kOldKernel;
    case ENXIO:
    case EINVAL:
    case EOPNOTSUPP:
      return fmt::format("{}: a line gives no interrupts on both edges, or not as an input ({})", chip,
                         system(error));
    case ENODEV:
      return chip + ": the chip has gone";
    default:
      return chip + ": the lines cannot be had: " + system(error);
  }
}

std::string outputWords(const std::string& chip, int error) {
  switch (error) {
    case EBUSY:
    case ENOTTY:
    case ENODEV:
      return requestWords(chip, error);
    case EACCES:
    case EPERM:
      return chip + ": lines of this chip may not be used as outputs";
    case ENXIO:
    case EINVAL:
    case EOPNOTSUPP:
      return fmt::format("{}: a line cannot be an output ({})", chip, system(error));
    default:
      return chip + ": the output lines cannot be had: " + system(error);
  }
}

std::string readWords(const std::string& chip, int error) {
  return error == ENODEV ? chip + ": the chip has gone while its lines were read"
                         : chip + ": its lines can no longer be read: " + system(error);
}

std::string writeWords(const std::string& chip, int error) {
  return error == ENODEV ? chip + ": the chip has gone while its lines were driven"
                         : chip + ": its lines can no longer be driven: " + system(error);
}

}  // namespace kerfbench::source
