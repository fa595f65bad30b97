#pragma once

#include <string>
#include <string_view>

namespace lambake {

inline constexpr std::string_view png_signature = "\x89PNG\r\n\x1a\n";
inline constexpr std::string_view jpeg_signature = "\xff\xd8\xff";

/// The PNG with the chunks alone that make its pixels. Colour profiles and gamma go, as colours are sRGB by
/// definition here, and with them what libpng would tell about them on standard error; so does a file that
/// ends early or whose bytes have changed.
/// @param png  begins with the signature. @param name  for messages.
/// @throws IoError if a chunk is cut off, or the checksum of one that is kept is not that of its bytes.
std::string critical_chunks(std::string_view png, const std::string& name);

/// @throws IoError if the JPEG ends before the marker of its end. libjpeg would make up the pixels that miss.
/// @param jpeg  begins with the signature. @param name  for messages.
void check_jpeg_end(std::string_view jpeg, const std::string& name);

/// Whether a JPEG has the four channels of CMYK, which browsers and glTF do not take.
/// @param jpeg  begins with the signature.
bool is_cmyk_jpeg(std::string_view jpeg);

}  // namespace lambake
