#include "lambake/io/output_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "lambake/core/error.h"

namespace lambake {

OutputFile::OutputFile(const std::string& path) : path_(path) {
  // In the same folder, so that moving it there is one step.
  const std::filesystem::path target(path);
  const std::filesystem::path beside =
      target.parent_path() / (".lambake-" + std::to_string(::getpid()) + "-" + target.filename().string());
  temporary_path_ = beside.string();
  stream_.open(temporary_path_, std::ios::binary | std::ios::trunc);
  if (!stream_) throw IoError(path_, std::string("cannot be written: ") + std::strerror(errno));
}

OutputFile::~OutputFile() {
  if (is_committed_) return;
  stream_.close();
  std::error_code ignored;  // Nothing can be told from a destructor; the file may never have been made.
  std::filesystem::remove(temporary_path_, ignored);
}

void OutputFile::write(const void* bytes, std::size_t n_bytes) {
  stream_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(n_bytes));
  if (!stream_) throw IoError(path_, std::string("cannot be written: ") + std::strerror(errno));
}

void OutputFile::commit() {
  stream_.close();
  if (!stream_) throw IoError(path_, std::string("cannot be written: ") + std::strerror(errno));
  std::error_code error;
  std::filesystem::rename(temporary_path_, path_, error);
  if (error) throw IoError(path_, "cannot be written: " + error.message());
  is_committed_ = true;
}

}  // namespace lambake
