#include "lambake/io/image_bytes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "lambake/core/error.h"

namespace lambake {
namespace {

/// CRC-32 of PNG, byte by byte: annex D of the specification.
constexpr std::array<std::uint32_t, 256> crc_table = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit) table[i] = (table[i] >> 1) ^ (table[i] & 1 ? 0xedb88320u : 0u);
  }
  return table;
}();

std::uint32_t crc_of(std::string_view bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) crc = crc_table[(crc ^ static_cast<unsigned char>(c)) & 0xff] ^ (crc >> 8);
  return ~crc;
}

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

/// Where the next marker of a JPEG is, behind its FF; `npos` if there is none. Not those within a scan: FF 00
/// stands for a byte of 255, FF D0 to D7 are restarts.
std::size_t find_marker(std::string_view jpeg, std::size_t at) {
  while ((at = jpeg.find('\xff', at)) != jpeg.npos && ++at < jpeg.size()) {
    const auto code = static_cast<unsigned char>(jpeg[at]);
    if (code != 0 && code != 0xff && (code < 0xd0 || code > 0xd7)) return at;
  }
  return jpeg.npos;
}

}  // namespace

std::string critical_chunks(std::string_view png, const std::string& name) {
  std::string kept(png_signature);
  for (std::size_t at = png_signature.size();;) {
    const std::uint64_t length = png.size() - at < 12 ? 0 : big_endian(png.substr(at, 4));
    if (png.size() - at < 12 || png.size() - at - 12 < length)
      throw IoError(name, "byte " + std::to_string(at) + ": expected a chunk of PNG, found the end");
    const std::string_view chunk = png.substr(at, static_cast<std::size_t>(length) + 12);
    const std::string_view type = chunk.substr(4, 4);
    if (type == "IHDR" || type == "PLTE" || type == "tRNS" || type == "IDAT" || type == "IEND") {
      if (crc_of(chunk.substr(4, chunk.size() - 8)) != big_endian(chunk.substr(chunk.size() - 4)))
        throw IoError(name, "byte " + std::to_string(at) + ": expected a chunk " + std::string(type) +
                                " that fits its checksum, found another");
      kept += chunk;
    }
    if (type == "IEND") return kept;
    at += chunk.size();
  }
}

void check_jpeg_end(std::string_view jpeg, const std::string& name) {
  for (std::size_t at = 2; (at = find_marker(jpeg, at)) != jpeg.npos;) {
    const auto code = static_cast<unsigned char>(jpeg[at++]);
    if (code == 0xd9) return;
    constexpr unsigned char temporary = 0x01, start = 0xd8;  // Nothing belongs to them.
    if (code != temporary && code != start) at += big_endian(jpeg.substr(std::min(at, jpeg.size()), 2));
  }
  throw IoError(name, "byte " + std::to_string(jpeg.size()) +
                          ": expected the end of the picture (FF D9), found the end of the file");
}

bool is_cmyk_jpeg(std::string_view jpeg) {
  for (std::size_t at = 2; (at = find_marker(jpeg, at)) != jpeg.npos;) {
    const auto code = static_cast<unsigned char>(jpeg[at++]);
    constexpr std::size_t n_channels_at = 7;  // Behind length, precision, height and width.
    const bool is_frame = (code & 0xf0) == 0xc0 && code != 0xc4 && code != 0xc8 && code != 0xcc;
    if (is_frame) return at + n_channels_at < jpeg.size() && jpeg[at + n_channels_at] == 4;
    at += big_endian(jpeg.substr(std::min(at, jpeg.size()), 2));
  }
  return false;
}

}  // namespace lambake
