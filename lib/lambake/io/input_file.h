#pragma once

#include <cstddef>
#include <fstream>
#include <string>

namespace lambake {

/// A file that is read piece by piece, more than once if need be: the bytes that it has when it is opened,
/// even if it grows. A pipe can be read only once: what comes out of it is kept in memory.
class InputFile {
 public:
  /// @param may_be_pipe  true for a file that the user names. Whatever else is no regular file may never end.
  /// @throws IoError if it is missing, a folder, a device, unreadable or empty.
  explicit InputFile(const std::string& path, bool may_be_pipe = true);

  std::size_t size() const { return size_; }
  /// Reads the next `n` bytes, or what is left if that is less; returns how many.
  /// @throws IoError if it cannot be read, or has become shorter.
  std::size_t read(char* to, std::size_t n);
  void rewind();
  /// All bytes; the file has nothing more to give then.
  std::string take();

 private:
  std::string path_;
  std::ifstream stream_;
  std::string piped_;
  std::size_t size_ = 0;
  std::size_t at_ = 0;  // The next byte.
  bool is_pipe_ = false;
};

/// All bytes of a file that the user names: a regular one or a pipe. @throws IoError as InputFile does.
std::string read_bytes(const std::string& path);

/// All bytes of a file that another file names: a regular one only.
std::string read_named_bytes(const std::string& path);

}  // namespace lambake
