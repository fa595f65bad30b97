#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lambake/io/input_file.h"

namespace lambake {

/// A text by blocks of whole lines, so that no more of it is in memory.
class TextBlocks {
 public:
  /// @param block_size  of most blocks, in bytes; a longer line has a block of its own.
  explicit TextBlocks(InputFile& file, std::size_t block_size = std::size_t{1} << 20);

  /// The next lines; empty at the end of the text. A line that ends with a backslash is not the last of a
  /// block. May be written to; valid until the next call.
  std::span<char> next();
  /// Begins again at the first line.
  void rewind();
  /// Bytes behind the block that was given last.
  std::size_t remaining() const;

 private:
  InputFile& file_;
  std::vector<char> buffer_;
  std::size_t n_held_ = 0;   // Bytes in the buffer.
  std::size_t n_given_ = 0;  // The first of them, which are the block that was given last.
  std::size_t n_read_ = 0;   // Bytes of the file.
};

}  // namespace lambake
