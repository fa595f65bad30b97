#include "lambake/io/output_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "lambake/core/error.h"

namespace lambake {

OutputFile::OutputFile(const std::string& path)
    : path_(path), temporary_(path), stream_(temporary_.path(), std::ios::binary | std::ios::trunc) {
  check_stream();
}

void OutputFile::write(const void* bytes, std::size_t n_bytes) {
  stream_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(n_bytes));
  check_stream();
}

void OutputFile::commit() {
  stream_.close();
  check_stream();
  std::error_code error;
  std::filesystem::rename(temporary_.path(), path_, error);
  if (error) throw IoError(path_, "cannot be written: " + error.message());
}

void OutputFile::check_stream() const {
  if (!stream_) throw IoError(path_, std::string("cannot be written: ") + std::strerror(errno));
}

void write_file(const std::string& path, const std::string& bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace lambake
