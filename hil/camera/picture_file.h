// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "twin/base/image.h"

namespace kerfbench::camera {

/// The picture in a file, PNG or JPEG, of at most 256 MiB. @throws base::ConfigError with the path.
GrayImage readPicture(const std::filesystem::path& path);

}  // namespace kerfbench::camera
