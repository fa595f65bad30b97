#include "lambake/io/image_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "lambake/core/error.h"
#include "lambake/io/image_bytes.h"

namespace lambake {
namespace {

/// Larger pictures are refused before anything is allocated for them: 64 Mi pixels take 1 GiB as an Image.
constexpr std::uint64_t max_image_pixels = std::uint64_t{1} << 26;

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

/// Bytes of the file that OpenImageIO writes under a name of this extension.
std::string encode_with(const std::string& format, const std::string& extension, const std::string& name,
                        const Picture& picture, OIIO::TypeDesc type, const void* pixels) {
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
  if (output == nullptr) throw IoError(name, "cannot be written: OpenImageIO has no writer for it");
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), 3, type);
  spec.attribute("oiio:ColorSpace", type == OIIO::TypeDesc::UINT8 ? "sRGB" : "Linear");
  // Otherwise the EXR writer stores the time of writing: same picture, same bytes.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput proxy(bytes);
  if (!output->set_ioproxy(&proxy) || !output->open("picture" + extension, spec) ||
      !output->write_image(type, pixels) || !output->close())
    throw IoError(name, "cannot be written: " + first_line(output->geterror(), "unknown reason"));
  return {bytes.begin(), bytes.end()};
}

std::string encode_png(const Picture& picture, const std::string& name) {
  return encode_with("png", ".png", name, picture, OIIO::TypeDesc::UINT8, encoded_pixels(picture).data());
}

std::string encode_exr(const Picture& picture, const std::string& name) {
  return encode_with("openexr", ".exr", name, picture, OIIO::TypeDesc::FLOAT, picture.pixels.data());
}

/// sRGB-encoded integers of 16 bit to linear.
std::vector<float> decode_table() {
  std::vector<float> table(65536);
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<float>(srgb_decode(static_cast<double>(i) / 65535));
  return table;
}

/// One pixel of 1 (grey), 2 (grey, alpha), 3 or 4 channels as RGBA.
template <typename Value>
std::array<Value, 4> rgba(const Value* p, int n_channels, Value opaque) {
  if (n_channels >= 3) return {p[0], p[1], p[2], n_channels > 3 ? p[3] : opaque};
  return {p[0], p[0], p[0], n_channels == 2 ? p[1] : opaque};
}

void take_pixels(const std::vector<std::uint8_t>& values, int n_channels, Image& image) {
  image.bytes.resize(values.size() / static_cast<std::size_t>(n_channels));
  for (std::size_t i = 0; i < image.bytes.size(); ++i) {
    const auto c =
        rgba(values.data() + i * static_cast<std::size_t>(n_channels), n_channels, std::uint8_t{255});
    image.bytes[i] = {c[0], c[1], c[2], c[3]};
  }
}

void take_pixels(const std::vector<std::uint16_t>& values, int n_channels, Image& image) {
  static const std::vector<float> linear = decode_table();
  image.pixels.resize(values.size() / static_cast<std::size_t>(n_channels));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const auto c =
        rgba(values.data() + i * static_cast<std::size_t>(n_channels), n_channels, std::uint16_t{65535});
    image.pixels[i] = {linear[c[0]], linear[c[1]], linear[c[2]], float(c[3]) / 65535.0f};
  }
}

void take_pixels(const std::vector<float>& values, int n_channels, Image& image) {  // linear already
  image.pixels.resize(values.size() / static_cast<std::size_t>(n_channels));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const auto c = rgba(values.data() + i * static_cast<std::size_t>(n_channels), n_channels, 1.0f);
    image.pixels[i] = {c[0], c[1], c[2], c[3]};
  }
}

/// The name by which OpenImageIO finds the reader for these bytes: what they are, not what they are called.
std::string name_by_content(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(png_signature)) return "image.png";
  if (text.starts_with(jpeg_signature)) return "image.jpg";
  if (text.starts_with("\x76\x2f\x31\x01")) return "image.exr";
  if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP")) return "image.webp";
  return name;
}

Image decoded(OIIO::ImageInput& input, const std::string& name) {
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
  const auto read = [&]<typename Value>(Value, OIIO::TypeDesc type) {
    std::vector<Value> values(n_values);
    if (!input.read_image(0, 0, 0, n_channels, type, values.data()))
      throw IoError(name, "cannot be decoded: " + first_line(input.geterror(), "unknown reason"));
    take_pixels(values, n_channels, image);
  };
  if (spec.format == OIIO::TypeDesc::UINT8)
    read(std::uint8_t{}, OIIO::TypeDesc::UINT8);
  else if (spec.format.is_floating_point())
    read(float{}, OIIO::TypeDesc::FLOAT);
  else
    read(std::uint16_t{}, OIIO::TypeDesc::UINT16);
  return image;
}

Image decode(std::span<const std::byte> bytes, const std::string& name) {
  OIIO::Filesystem::IOMemReader proxy(bytes.data(), bytes.size());
  OIIO::Filesystem::IOProxy* const proxy_address = &proxy;
  OIIO::ImageSpec config;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy_address);
  config.attribute("oiio:UnassociatedAlpha", 1);  // opacity is kept apart from colour, not multiplied into it
  const std::unique_ptr<OIIO::ImageInput> input =
      OIIO::ImageInput::open(name_by_content(bytes, name), &config, &proxy);
  if (!input) throw IoError(name, "cannot be decoded: " + first_line(OIIO::geterror(), "unknown reason"));
  return decoded(*input, name);
}

}  // namespace
}  // namespace lambake

const lambake::ImageCodec* lambake_image_codec() {
  static constexpr lambake::ImageCodec codec{lambake::encode_png, lambake::encode_exr, lambake::decode};
  return &codec;
}
