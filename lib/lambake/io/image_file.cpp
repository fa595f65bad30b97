#include "lambake/io/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "lambake/core/error.h"
#include "lambake/io/output_file.h"

namespace lambake {
namespace {

/// Larger pictures are refused before anything is allocated for them: 64 Mi pixels take 1 GiB as an Image.
constexpr std::uint64_t max_image_pixels = std::uint64_t{1} << 26;

constexpr std::string_view png_signature = "\x89PNG\r\n\x1a\n";

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// OpenImageIO's messages may have several lines; the first says what happened.
std::string first_line(const std::string& text, const std::string& otherwise) {
  const std::string line = text.substr(0, text.find('\n'));
  return line.empty() ? otherwise : line;
}

std::vector<Srgb8> encoded_pixels(const Picture& picture) {
  std::vector<Srgb8> pixels(picture.n_pixels());
  std::transform(picture.pixels.begin(), picture.pixels.end(), pixels.begin(), to_srgb8);
  return pixels;
}

void write_with(OIIO::ImageOutput* output, const std::string& path, const std::string& name,
                const Picture& picture, OIIO::TypeDesc type, const void* pixels,
                OIIO::Filesystem::IOProxy* proxy) {
  if (output == nullptr) throw IoError(name, "cannot be written: OpenImageIO has no writer for it");
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), 3, type);
  spec.attribute("oiio:ColorSpace", type == OIIO::TypeDesc::UINT8 ? "sRGB" : "Linear");
  // Otherwise the EXR writer stores the time of writing: same picture, same bytes.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  if (proxy != nullptr) output->set_ioproxy(proxy);
  if (!output->open(path, spec) || !output->write_image(type, pixels) || !output->close())
    throw IoError(name, "cannot be written: " + first_line(output->geterror(), "unknown reason"));
}

std::string png_bytes(const Picture& picture, const std::string& name) {
  const std::vector<Srgb8> pixels = encoded_pixels(picture);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput proxy(bytes);
  write_with(OIIO::ImageOutput::create("png").get(), "picture.png", name, picture, OIIO::TypeDesc::UINT8,
             pixels.data(), &proxy);
  return {bytes.begin(), bytes.end()};
}

/// sRGB-encoded integers to linear, by table.
template <typename Integer>
std::vector<float> decode_table() {
  std::vector<float> table(std::size_t{std::numeric_limits<Integer>::max()} + 1);
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] =
        static_cast<float>(srgb_decode(static_cast<double>(i) / static_cast<double>(table.size() - 1)));
  return table;
}

/// One pixel of 1 (grey), 2 (grey, alpha), 3 or 4 channels as RGBA.
template <typename Value>
std::array<Value, 4> rgba(const Value* p, int n_channels, Value opaque) {
  if (n_channels >= 3) return {p[0], p[1], p[2], n_channels > 3 ? p[3] : opaque};
  return {p[0], p[0], p[0], n_channels == 2 ? p[1] : opaque};
}

template <typename Integer>
void decode_pixels(const std::vector<Integer>& values, int n_channels, Image& image) {
  static const std::vector<float> linear = decode_table<Integer>();
  constexpr Integer opaque = std::numeric_limits<Integer>::max();
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const auto c = rgba(values.data() + i * static_cast<std::size_t>(n_channels), n_channels, opaque);
    image.pixels[i] = {linear[c[0]], linear[c[1]], linear[c[2]], float(c[3]) / float(opaque)};
  }
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The name by which OpenImageIO finds the reader for these bytes: what they are, not what they are called.
std::string name_by_content(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text = as_text(bytes);
  if (text.starts_with(png_signature)) return "image.png";
  if (text.starts_with("\xff\xd8\xff")) return "image.jpg";
  if (text.starts_with("\x76\x2f\x31\x01")) return "image.exr";
  return name;
}

/// The PNG with the chunks alone that make its pixels. Colour profiles and gamma go, as colours are sRGB by
/// definition here, and with them what libpng would tell about them on standard error; so does a file that
/// ends early.
std::string critical_chunks(std::string_view png, const std::string& name) {
  std::string kept(png_signature);
  for (std::size_t at = png_signature.size();;) {
    std::uint64_t length = 0;
    if (png.size() - at >= 12)
      for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<unsigned char>(png[at + i]);
    if (png.size() - at < 12 || png.size() - at - 12 < length)
      throw IoError(name, "byte " + std::to_string(at) + ": expected a chunk of PNG, found the end");
    const std::string_view chunk = png.substr(at, static_cast<std::size_t>(length) + 12);
    const std::string_view type = chunk.substr(4, 4);
    if (type == "IHDR" || type == "PLTE" || type == "tRNS" || type == "IDAT" || type == "IEND") kept += chunk;
    if (type == "IEND") return kept;
    at += chunk.size();
  }
}

Image decode(OIIO::ImageInput& input, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.width <= 0 || spec.height <= 0 || spec.depth != 1 || spec.nchannels < 1)
    throw IoError(name, "expected an image with pixels");
  const std::uint64_t n = std::uint64_t(spec.width) * std::uint64_t(spec.height);
  if (n > max_image_pixels)
    throw IoError(name, "expected an image of at most " + std::to_string(max_image_pixels) +
                            " pixels, found " + std::to_string(spec.width) + "x" +
                            std::to_string(spec.height));
  const int n_channels = std::min(spec.nchannels, 4);
  Image image{static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), {}};
  const std::size_t n_values = static_cast<std::size_t>(n) * static_cast<std::size_t>(n_channels);
  const auto read = [&](OIIO::TypeDesc type, void* values) {
    if (!input.read_image(0, 0, 0, n_channels, type, values))
      throw IoError(name, "cannot be decoded: " + first_line(input.geterror(), "unknown reason"));
  };
  if (spec.format == OIIO::TypeDesc::UINT8) {
    std::vector<std::uint8_t> values(n_values);
    read(OIIO::TypeDesc::UINT8, values.data());
    image.pixels.resize(n);
    decode_pixels(values, n_channels, image);
  } else if (spec.format.is_floating_point()) {  // linear already
    std::vector<float> values(n_values);
    read(OIIO::TypeDesc::FLOAT, values.data());
    image.pixels.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto c = rgba(values.data() + i * static_cast<std::size_t>(n_channels), n_channels, 1.0f);
      image.pixels[i] = {c[0], c[1], c[2], c[3]};
    }
  } else {
    std::vector<std::uint16_t> values(n_values);
    read(OIIO::TypeDesc::UINT16, values.data());
    image.pixels.resize(n);
    decode_pixels(values, n_channels, image);
  }
  return image;
}

}  // namespace

void write_picture(const std::string& path, const Picture& picture) {
  const std::string extension = lower_extension(path);
  if (extension == ".png") {
    OutputFile file(path);
    file.write(png_bytes(picture, path));
    file.commit();
  } else if (extension == ".exr") {
    OutputFile file(path);
    write_with(OIIO::ImageOutput::create("openexr").get(), file.temporary_path(), path, picture,
               OIIO::TypeDesc::FLOAT, picture.pixels.data(), nullptr);
    file.commit();
  } else {
    throw InvalidOption(path + ": expected a picture's name to end in .png or .exr");
  }
}

std::string encode_png(const Picture& picture) {
  return png_bytes(picture, "picture.png");
}

Image decode_image(std::span<const std::byte> bytes, const std::string& name) {
  std::string png;
  if (as_text(bytes).starts_with(png_signature)) {
    png = critical_chunks(as_text(bytes), name);
    bytes = std::as_bytes(std::span(png.data(), png.size()));
  }
  OIIO::Filesystem::IOMemReader proxy(bytes.data(), bytes.size());
  OIIO::Filesystem::IOProxy* const proxy_address = &proxy;
  OIIO::ImageSpec config;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy_address);
  config.attribute("oiio:UnassociatedAlpha", 1);  // opacity is kept apart from colour, not multiplied into it
  const std::unique_ptr<OIIO::ImageInput> input =
      OIIO::ImageInput::open(name_by_content(bytes, name), &config, &proxy);
  if (!input) throw IoError(name, "cannot be decoded: " + first_line(OIIO::geterror(), "unknown reason"));
  return decode(*input, name);
}

Image read_image(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad())
    throw IoError(path, std::string("cannot be read: ") + std::strerror(errno));
  return decode_image(std::as_bytes(std::span(bytes.data(), bytes.size())), path);
}

}  // namespace lambake
