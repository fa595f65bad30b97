#include "lambake/io/output_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "lambake/core/error.h"

namespace lambake {

std::string target_of(const std::string& path) {
  constexpr int most_links = 40;  // As the system takes.
  std::filesystem::path target = path;
  std::error_code error;
  for (int i = 0; i < most_links && std::filesystem::is_symlink(target, error); ++i)
    target = target.parent_path() / std::filesystem::read_symlink(target, error);
  const std::filesystem::file_status status = std::filesystem::status(target, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw IoError(path, "expected a file to replace, found a folder, device or pipe");
  return target.string();
}

OutputFile::OutputFile(const std::string& path)
    : path_(target_of(path)),
      temporary_(path_),
      stream_(temporary_.path(), std::ios::binary | std::ios::trunc) {
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
