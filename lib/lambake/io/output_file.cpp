#include "lambake/io/output_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "lambake/core/error.h"

namespace lambake {

std::filesystem::path temporary_beside(const std::filesystem::path& target) {
  return target.parent_path() / (".lambake-" + std::to_string(::getpid()) + "-" + target.filename().string());
}

OutputFile::OutputFile(const std::string& path)
    : path_(path), temporary_path_(temporary_beside(path).string()) {
  stream_.open(temporary_path_, std::ios::binary | std::ios::trunc);
  check_stream();
}

OutputFile::~OutputFile() {
  if (is_committed_) return;
  stream_.close();
  std::error_code ignored;  // Nothing can be told from a destructor; the file may never have been made.
  std::filesystem::remove(temporary_path_, ignored);
}

void OutputFile::write(const void* bytes, std::size_t n_bytes) {
  stream_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(n_bytes));
  check_stream();
}

void OutputFile::commit() {
  stream_.close();
  check_stream();
  std::error_code error;
  std::filesystem::rename(temporary_path_, path_, error);
  if (error) throw IoError(path_, "cannot be written: " + error.message());
  is_committed_ = true;
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
