#include "lambake/io/image_file.h"

#include <dlfcn.h>

#include <string_view>
#include <utility>

#include "lambake/core/error.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/image_bytes.h"
#include "lambake/io/image_codec.h"
#include "lambake/io/input_file.h"
#include "lambake/io/output_file.h"

namespace lambake {
namespace {

/// Found by the run path of whoever is linked with this library: lib/CMakeLists.txt.
const ImageCodec* load_codec() {
  void* const module = ::dlopen(LAMBAKE_IMAGE_CODEC, RTLD_NOW | RTLD_LOCAL);
  void* const entry = module == nullptr ? nullptr : ::dlsym(module, "lambake_image_codec");
  if (entry == nullptr)
    throw IoError(LAMBAKE_IMAGE_CODEC, std::string("pictures cannot be read or written: ") + ::dlerror());
  return reinterpret_cast<decltype(&lambake_image_codec)>(entry)();
}

/// Loaded by the first call, and never unloaded; a call after one that failed tries again.
const ImageCodec& codec() {
  static const ImageCodec* const loaded = load_codec();
  return *loaded;
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void write_picture(const std::string& path, const Picture& picture) {
  const std::string extension = file_extension(path);
  if (extension != "png" && extension != "exr")
    throw InvalidOption(path + ": expected a picture's name to end in .png or .exr");
  OutputFile file(path);
  file.write(extension == "png" ? codec().encode_png(picture, path) : codec().encode_exr(picture, path));
  file.commit();
}

std::string encode_png(const Picture& picture) {
  return codec().encode_png(picture, "picture.png");
}

Image decode_image(std::span<const std::byte> bytes, const std::string& name) {
  if (as_text(bytes).starts_with(jpeg_signature)) check_jpeg_end(as_text(bytes), name);
  if (!as_text(bytes).starts_with(png_signature)) return codec().decode(bytes, name);
  const std::string png = critical_chunks(as_text(bytes), name);
  return codec().decode(std::as_bytes(std::span(png.data(), png.size())), name);
}

std::string mime_type_of(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return "image/png";
  if (bytes.starts_with("\xFF\xD8")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  return "";
}

bool is_black(const Image& image) {
  for (std::size_t i = 0; i < image.n_pixels(); ++i)
    if (const glm::vec4 pixel = image.pixel(i); glm::vec3(pixel) != glm::vec3(0)) return false;
  return image.n_pixels() > 0;
}

Image read_image(const std::string& path) {
  std::string bytes = read_named_bytes(path);
  Image image = decode_image(std::as_bytes(std::span(bytes.data(), bytes.size())), path);
  const std::string type = mime_type_of(bytes);
  if (type == "image/png" || (type == "image/jpeg" && !is_cmyk_jpeg(bytes))) image.file = std::move(bytes);
  return image;
}

}  // namespace lambake
