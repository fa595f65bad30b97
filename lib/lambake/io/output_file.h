#pragma once

#include <cstddef>
#include <fstream>
#include <string>

#include "lambake/io/temporary.h"

namespace lambake {

/// Where the bytes of a file go: what symbolic links lead to is replaced, not the links.
/// @throws IoError if what is there is no file.
std::string target_of(const std::string& path);

/// A file that appears whole or not at all: written beside its place, moved there by commit(). Without a
/// commit it is removed. Writing errors throw IoError.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);

  void write(const void* bytes, std::size_t n_bytes);
  void write(const std::string& text) { write(text.data(), text.size()); }
  /// Where the bytes are before the commit.
  std::string temporary_path() const { return temporary_.path().string(); }
  void commit();

 private:
  void check_stream() const;

  std::string path_;
  Temporary temporary_;
  std::ofstream stream_;  // Closed before the file is removed.
};

/// Writes all of a file, whole or not at all. @throws IoError.
void write_file(const std::string& path, const std::string& bytes);

}  // namespace lambake
