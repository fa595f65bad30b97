#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "lambake/scene/material.h"
#include "lambake/scene/picture.h"

namespace lambake {

/// What turns pictures into bytes of a file and back, by OpenImageIO. It is a module of its own, loaded when
/// a first picture is read or written: the libraries that OpenImageIO brings along would otherwise take most
/// of the time of a small bake. All functions throw IoError, with `name` in the message; any number of
/// threads may call them.
struct ImageCodec {
  std::string (*encode_png)(const Picture& picture, const std::string& name);  ///< sRGB-encoded 8 bit RGB.
  std::string (*encode_exr)(const Picture& picture, const std::string& name);  ///< Linear float RGB.
  /// Of whatever OpenImageIO reads; colours are decoded from sRGB unless stored as floats.
  Image (*decode)(std::span<const std::byte> bytes, const std::string& name);
};

}  // namespace lambake

/// The module's only entry.
extern "C" const lambake::ImageCodec* lambake_image_codec();
