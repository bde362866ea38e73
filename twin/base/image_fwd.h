// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The names of twin/base/image.h, for headers that hand pictures on without looking into them.
namespace kerfbench {

struct GrayImage;
struct Frame;

}  // namespace kerfbench
