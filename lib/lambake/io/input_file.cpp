#include "lambake/io/input_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "lambake/core/error.h"

namespace lambake {

std::string read_bytes(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) throw IoError(path, "expected a file, found a folder");
  if (!std::filesystem::exists(status)) throw IoError(path, "expected a file, found none");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw IoError(path, std::string("cannot be opened: ") + std::strerror(errno));
  std::string bytes;
  if (std::filesystem::is_regular_file(status)) {
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw IoError(path, "cannot be read: " + error.message());
    bytes.resize(size);
    stream.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    if (stream.bad()) throw IoError(path, "cannot be read");
  } else {  // A pipe has no size.
    char block[65536];
    while (stream.read(block, sizeof block) || stream.gcount() > 0)
      bytes.append(block, static_cast<std::size_t>(stream.gcount()));
  }
  if (bytes.empty()) throw IoError(path, "expected content, found no bytes");
  return bytes;
}

}  // namespace lambake
