// SPDX-License-Identifier: Apache-2.0
// A controller board made of a release: see --help.
#include <fmt/format.h>
#include <sched.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "hil/machine_file/machine_file.h"
#include "hil/source/open.h"
#include "tests/board/sim_board.h"

namespace {

namespace fs = std::filesystem;
using namespace kerfbench;

struct BoardArguments {
  fs::path machine, image, child, chip, tty;
  std::string mcu{"atmega2560"};
  std::vector<std::string> lines;
  double step_us{200};
  double delay_us{1000};
  double seconds{30};
  int priority{};
};

std::uint64_t nanoseconds(double time_us) { return static_cast<std::uint64_t>(1e3 * time_us); }

/// Parses lines, "galvo_x_pul=4", and so on.
std::map<Signal, unsigned> linesFrom(const std::vector<std::string>& words) {
  std::map<Signal, unsigned> lines;
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    const auto signal = signalFromName(word.substr(0, equals));
    if (!signal || equals == std::string::npos)
      throw std::runtime_error(fmt::format("'{}' is no SIGNAL=LINE", word));
    lines[*signal] = static_cast<unsigned>(std::stoul(word.substr(equals + 1)));
  }
  return lines;
}

/// Takes a priority, for the release as well, which is a child. A board shares no processor with the bench;
/// one that does must have precedence over it.
void takePriority(int priority) {
  if (priority == 0) return;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0)
    throw std::system_error(errno, std::generic_category(), "real-time priority");
}

void runBoard(const BoardArguments& arguments) {
  takePriority(arguments.priority);
  source::ChildSourceOptions child;
  child.image = arguments.image;
  // A native release is itself the child.
  child.child = arguments.child.empty() ? arguments.image : arguments.child;
  child.mcu = arguments.mcu;
  const auto release = source::openChild(child);
  const std::map<Signal, unsigned> lines = linesFrom(arguments.lines);
  std::vector<Signal> wired;
  for (const auto& [signal, line] : lines) wired.push_back(signal);
  board::SimBoard ports(arguments.chip, lines, arguments.tty);
  const board::BoardOptions options{.step_ns = nanoseconds(arguments.step_us),
                                    .delay_ns = nanoseconds(arguments.delay_us),
                                    .run_ns = nanoseconds(1e6 * arguments.seconds)};
  board::Board the_board(*release, machine_file::readMachineFile(arguments.machine).machine.signals, wired,
                         ports, options);
  fmt::print("ready\n");
  std::fflush(stdout);
  const board::BoardPace pace = the_board.run();
  fmt::print("{} strokes, at worst {:.1f} us late; inputs seen every {:.1f} us at worst{}\n", pace.strokes,
             1e-3 * static_cast<double>(pace.worst_late_ns), 1e-3 * static_cast<double>(pace.worst_step_ns),
             pace.halted ? "; the release halted: " + release->message() : "");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "A controller board made of a release: its pins are lines of a chip of the kernel's gpio-sim, its UART "
      "is "
      "a\nterminal of the kernel's. It runs in real time and says 'ready' when it does, and in the end how "
      "well "
      "time was\nkept. Made for tests in a guest; a test tool, no part of the product.",
      "kerfbench-board"};
  BoardArguments arguments;
  app.add_option("--machine", arguments.machine, "Machine file: pins of the release")->required();
  app.add_option("--image", arguments.image, "The release")->required();
  app.add_option("--child", arguments.child, "Emulator (kerfbench-avr); none for a native release");
  app.add_option("--mcu", arguments.mcu, "Of an emulated release")->capture_default_str();
  app.add_option("--chip", arguments.chip, "/sys/devices/platform/gpio-sim.0/gpiochip1")->required();
  app.add_option("--line", arguments.lines, "SIGNAL=LINE, as galvo_x_pul=4; as often as there are pins")
      ->required();
  app.add_option("--tty", arguments.tty, "Link to be made to the bench's end of the UART")->required();
  app.add_option("--step-us", arguments.step_us, "Inputs are looked at so often")->capture_default_str();
  app.add_option("--delay-us", arguments.delay_us, "What goes out comes so much later than in the release")
      ->capture_default_str();
  app.add_option("--priority", arguments.priority, "Of SCHED_FIFO, above the bench's 49; 0: none")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "Of real time")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    runBoard(arguments);
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "kerfbench-board: {}\n", e.what());
    return 1;
  }
}
