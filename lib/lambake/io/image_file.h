#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "lambake/scene/material.h"
#include "lambake/scene/picture.h"

namespace lambake {

/// Writes a picture by extension, whole or not at all: .png (sRGB-encoded 8 bit RGB), .exr (linear float
/// RGB).
/// @throws IoError; InvalidOption for another extension.
void write_picture(const std::string& path, const Picture& picture);

/// Bytes of a PNG file of the picture, for embedding. @throws IoError.
std::string encode_png(const Picture& picture);

/// "image/png", "image/jpeg" or "image/webp" by how a file begins; otherwise "".
std::string mime_type_of(std::string_view bytes);

/// Decodes the bytes of a PNG or JPEG file (or whatever OpenImageIO reads); colours are decoded from sRGB.
/// @param name  for messages. @throws IoError.
Image decode_image(std::span<const std::byte> bytes, const std::string& name);

/// The same from a file, whose bytes are kept if glTF can hold them: PNG and JPEG. @throws IoError.
Image read_image(const std::string& path);

/// Whether it has pixels and all of them are black.
bool is_black(const Image& image);

}  // namespace lambake
