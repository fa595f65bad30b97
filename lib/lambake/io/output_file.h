#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

namespace lambake {

/// Where something is written that is then moved to `target`: in the same folder, so that moving it is one
/// step.
std::filesystem::path temporary_beside(const std::filesystem::path& target);

/// A file that appears whole or not at all: written beside its place, moved there by commit(). Without a
/// commit the destructor removes it. Writing errors throw IoError.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* bytes, std::size_t n_bytes);
  void write(const std::string& text) { write(text.data(), text.size()); }
  /// Where the bytes are before the commit.
  const std::string& temporary_path() const { return temporary_path_; }
  void commit();

 private:
  void check_stream() const;

  std::string path_, temporary_path_;
  std::ofstream stream_;
  bool is_committed_ = false;
};

/// Writes all of a file, whole or not at all. @throws IoError.
void write_file(const std::string& path, const std::string& bytes);

}  // namespace lambake
