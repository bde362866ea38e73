// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/analyser/sigrok_child/library.h"
#include "hil/source/analyser/sigrok_child/sigrok.h"

namespace kerfbench::sigrok_child {
namespace {

void tellDevice(Library& library, sr_dev_inst* device, const Sink& sink) {
  if (const int code = sr_dev_open(device); code != SR_OK) {
    sink(Frame::kFault, describe(device) + ": cannot be opened: " + library.why(code));
    return;
  }
  const OpenDevice open(device);
  std::string lines = std::string("driver ") + sr_dev_inst_driver_get(device)->name + "\nname " +
                      nameOf(device) + "\nserial " + textOf(sr_dev_inst_sernum_get(device)) + "\nconn " +
                      textOf(sr_dev_inst_connid_get(device)) + "\nrates " + ratesOf(device) + "\n";
  for (const sr_channel* channel : logicChannels(device)) lines += "channel " + textOf(channel->name) + "\n";
  sink(Frame::kDevice, lines);
}

}  // namespace

void listAnalysers(const Sink& sink) {
  Library library;
  const auto drivers = library.drivers();
  std::string lines = std::string("library libsigrok ") + sr_package_version_string_get() + "\n";
  for (const sr_dev_driver* driver : drivers) lines += std::string("driver ") + driver->name + "\n";
  sink(Frame::kLibrary, lines);
  for (sr_dev_driver* const driver : drivers) {
    try {
      for (sr_dev_inst* const device : library.scan(driver, "")) tellDevice(library, device, sink);
    } catch (const SigrokError& e) {
      sink(Frame::kFault, e.what());
    }
  }
  sink(Frame::kListed, "");
}

}  // namespace kerfbench::sigrok_child
