#include "lambake/io/text_blocks.h"

#include <algorithm>

namespace lambake {
namespace {

/// Where the last whole line of `text` ends that no backslash continues, or 0.
std::size_t end_of_lines(std::span<const char> text) {
  for (std::size_t end = text.size(); end > 0; --end) {
    const char c = text[end - 1];
    // CR may be the first half of CR LF.
    if (c != '\n' && (c != '\r' || end == text.size() || text[end] == '\n')) continue;
    std::size_t last = end - 1;
    if (c == '\n' && last > 0 && text[last - 1] == '\r') --last;
    if (last == 0 || text[last - 1] != '\\') return end;
  }
  return 0;
}

}  // namespace

TextBlocks::TextBlocks(InputFile& file, std::size_t block_size)
    : file_(file), buffer_(std::min(block_size, file.size() + 1)) {}

std::span<char> TextBlocks::next() {
  const auto begin = buffer_.begin();
  std::copy(begin + static_cast<std::ptrdiff_t>(n_given_), begin + static_cast<std::ptrdiff_t>(n_held_),
            begin);
  n_held_ -= n_given_;
  n_given_ = 0;
  for (;;) {
    const std::size_t n = file_.read(buffer_.data() + n_held_, buffer_.size() - n_held_);
    n_read_ += n;
    n_held_ += n;
    const bool is_end = n_held_ < buffer_.size();
    n_given_ = is_end ? n_held_ : end_of_lines(buffer_);
    if (is_end || n_given_ > 0) return std::span(buffer_).first(n_given_);
    buffer_.resize(2 * buffer_.size());
  }
}

void TextBlocks::rewind() {
  file_.rewind();
  n_held_ = n_given_ = n_read_ = 0;
}

std::size_t TextBlocks::remaining() const {
  return (n_held_ - n_given_) + (file_.size() - n_read_);
}

}  // namespace lambake
