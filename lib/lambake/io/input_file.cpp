#include "lambake/io/input_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "lambake/core/error.h"

namespace lambake {

namespace {

std::string read(const std::string& path, bool may_be_pipe) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) throw IoError(path, "expected a file, found a folder");
  if (!std::filesystem::exists(status)) throw IoError(path, "expected a file, found none");
  const bool is_regular = std::filesystem::is_regular_file(status);
  if (!is_regular && !(may_be_pipe && std::filesystem::is_fifo(status)))
    throw IoError(path, "expected a file, found a device or pipe");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw IoError(path, std::string("cannot be opened: ") + std::strerror(errno));
  std::string bytes;
  if (is_regular) {
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

}  // namespace

std::string read_bytes(const std::string& path) {
  return read(path, true);
}

std::string read_named_bytes(const std::string& path) {
  return read(path, false);
}

}  // namespace lambake
