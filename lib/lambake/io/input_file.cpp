#include "lambake/io/input_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "lambake/core/error.h"

namespace lambake {

InputFile::InputFile(const std::string& path, bool may_be_pipe) : path_(path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) throw IoError(path, "expected a file, found a folder");
  if (status.type() == std::filesystem::file_type::not_found)
    throw IoError(path, "expected a file, found none");
  if (!std::filesystem::exists(status)) throw IoError(path, "cannot be opened: " + error.message());
  is_pipe_ = may_be_pipe && std::filesystem::is_fifo(status);
  if (!is_pipe_ && !std::filesystem::is_regular_file(status))
    throw IoError(path, "expected a file, found a device or pipe");
  stream_.open(path, std::ios::binary);
  if (!stream_) throw IoError(path, std::string("cannot be opened: ") + std::strerror(errno));
  if (is_pipe_) {  // It has no size.
    char block[65536];
    while (stream_.read(block, sizeof block) || stream_.gcount() > 0)
      piped_.append(block, static_cast<std::size_t>(stream_.gcount()));
    if (stream_.bad()) throw IoError(path, "cannot be read");
    size_ = piped_.size();
  } else {
    size_ = std::filesystem::file_size(path, error);
    if (error) throw IoError(path, "cannot be read: " + error.message());
  }
  if (size_ == 0) throw IoError(path, "expected content, found no bytes");
}

std::size_t InputFile::read(char* to, std::size_t n) {
  n = std::min(n, size_ - at_);
  if (is_pipe_) {
    std::memcpy(to, piped_.data() + at_, n);
  } else {
    stream_.read(to, static_cast<std::streamsize>(n));
    if (stream_.bad()) throw IoError(path_, "cannot be read");
    const auto n_read = static_cast<std::size_t>(stream_.gcount());
    if (n_read < n)
      throw IoError(path_,
                    fmt::format("byte {}: expected {} bytes as when it was opened, found the end of the "
                                "file",
                                at_ + n_read, size_));
  }
  at_ += n;
  return n;
}

void InputFile::rewind() {
  at_ = 0;
  stream_.clear();
  stream_.seekg(0);
}

std::string InputFile::take() {
  if (is_pipe_) return std::move(piped_);
  std::string bytes(size_, '\0');
  bytes.resize(read(bytes.data(), bytes.size()));
  return bytes;
}

std::string read_bytes(const std::string& path) {
  return InputFile(path).take();
}

std::string read_named_bytes(const std::string& path) {
  return InputFile(path, false).take();
}

}  // namespace lambake
