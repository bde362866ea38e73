// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <libsigrok/libsigrok.h>

#include <memory>
#include <string>
#include <vector>

namespace kerfbench::sigrok_child {

struct FreeHandle {
  void operator()(sr_context* context) const { sr_exit(context); }
  void operator()(sr_session* session) const { sr_session_destroy(session); }
  void operator()(GVariant* variant) const { g_variant_unref(variant); }
  void operator()(GSList* list) const { g_slist_free(list); }
  void operator()(GArray* array) const { g_array_free(array, TRUE); }
};
template <typename T>
using Handle = std::unique_ptr<T, FreeHandle>;

/// Elements of a list of libsigrok's, which stay its own.
template <typename T>
std::vector<T*> elementsOf(GSList* list) {
  std::vector<T*> elements;
  for (; list != nullptr; list = list->next) elements.push_back(static_cast<T*>(list->data));
  return elements;
}

inline std::string textOf(const char* text) { return text == nullptr ? "" : text; }

/// Keeps a device open.
class OpenDevice {
 public:
  explicit OpenDevice(sr_dev_inst* device) : device_(device) {}
  ~OpenDevice() { sr_dev_close(device_); }
  OpenDevice(const OpenDevice&) = delete;
  OpenDevice& operator=(const OpenDevice&) = delete;

 private:
  sr_dev_inst* device_;
};

}  // namespace kerfbench::sigrok_child
