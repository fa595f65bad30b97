#pragma once

#include <cstddef>
#include <fstream>
#include <string>

namespace lambake {

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
  std::string path_, temporary_path_;
  std::ofstream stream_;
  bool is_committed_ = false;
};

}  // namespace lambake
